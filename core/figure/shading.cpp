#include "core/figure/shading.hpp"

#include <algorithm>
#include <cmath>

#include "core/figure/preview.hpp"

namespace unwrapd::figure {
namespace {

constexpr double kSharp = 0.5;  // cosine between a face's normal and its vertex's
constexpr double kAmbient = 0.44, kKey = 0.56, kFill = 0.16, kGloss = 0.10;
constexpr double kInside = 0.72;  // how bright the inner side is

const Vec3 kKeyLamp = Vec3(-0.45, 0.65, 0.75).normalized();
const Vec3 kFillLamp = Vec3(0.8, -0.1, 0.45).normalized();
const Vec3 kHalfway = (kKeyLamp + Vec3::UnitZ()).normalized();  // for the gloss, Blinn 1977

constexpr double kMaxSquare = 1e15;  // beyond it neighbours cannot be told apart

std::int64_t square_of(double x, double checks) {
  return static_cast<std::int64_t>(std::floor(std::clamp(checks * x, -kMaxSquare, kMaxSquare)));
}

double to_the_32nd(double x) {
  for (int k = 0; k < 5; ++k) x *= x;
  return x;
}

Rgb under(const Rgb& paint, double light, double gloss) {
  Rgb colour;
  for (std::size_t part = 0; part < 3; ++part) {
    const double value = paint[part] * light + 255 * gloss;
    colour[part] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
  }
  return colour;
}

}  // namespace

Vec3 corner_normal(const Vec3& face, const Vec3& vertex) {
  return face.dot(vertex) > kSharp ? vertex : face;
}

Lit lit(const FaceLook& look, const std::array<double, 3>& weight) {
  const Vec3 sum =
      weight[0] * look.normal[0] + weight[1] * look.normal[1] + weight[2] * look.normal[2];
  const double length = sum.norm();
  const Vec3 normal = length > 0 ? Vec3(sum / length) : Vec3(Vec3::UnitZ());
  const double light = kAmbient + kKey * std::max(0.0, normal.dot(kKeyLamp)) +
                       kFill * std::max(0.0, normal.dot(kFillLamp));
  const double gloss = kGloss * to_the_32nd(std::max(0.0, normal.dot(kHalfway)));
  const double seen = light * (look.is_inside ? kInside : 1);
  return {.light = under(kLightCheck, seen, gloss), .dark = under(kDarkCheck, seen, gloss)};
}

bool is_dark(const FaceLook& look, const std::array<double, 3>& weight, double checks) {
  const Vec2 uv = weight[0] * look.uv[0] + weight[1] * look.uv[1] + weight[2] * look.uv[2];
  return ((square_of(uv.x(), checks) + square_of(uv.y(), checks)) & 1) != 0;
}

}  // namespace unwrapd::figure
