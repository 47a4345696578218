#include "core/figure/shading.hpp"

#include <algorithm>
#include <cmath>

#include "core/figure/preview.hpp"

namespace unwrapd {
namespace {

constexpr double kSharp = 0.5;  // cosine between a face's normal and its vertex's
constexpr double kAmbient = 0.44, kKey = 0.56, kFill = 0.16, kGloss = 0.10;
constexpr double kInside = 0.72;  // how bright the inner side is

const Vec3 kKeyLamp = Vec3(-0.45, 0.65, 0.75).normalized();
const Vec3 kFillLamp = Vec3(0.8, -0.1, 0.45).normalized();
const Vec3 kHalfway = (kKeyLamp + Vec3::UnitZ()).normalized();  // for the gloss, Blinn 1977

constexpr double kMaxSquare = 1e15;  // beyond it neighbours cannot be told apart

bool is_dark(const Vec2& uv, double checks) {
  const auto number = [checks](double x) {
    return static_cast<std::int64_t>(std::floor(std::clamp(checks * x, -kMaxSquare, kMaxSquare)));
  };
  return ((number(uv.x()) + number(uv.y())) & 1) != 0;
}

double to_the_32nd(double x) {
  for (int k = 0; k < 5; ++k) x *= x;
  return x;
}

}  // namespace

Vec3 corner_normal(const Vec3& face, const Vec3& vertex) {
  return face.dot(vertex) > kSharp ? vertex : face;
}

Rgb shaded(const FaceLook& look, const std::array<double, 3>& weight, double checks) {
  Vec3 normal = Vec3::Zero();
  Vec2 uv = Vec2::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    normal += weight[k] * look.normal[k];
    uv += weight[k] * look.uv[k];
  }
  const double length = normal.norm();
  normal = length > 0 ? Vec3(normal / length) : Vec3(Vec3::UnitZ());
  const double light = kAmbient + kKey * std::max(0.0, normal.dot(kKeyLamp)) +
                       kFill * std::max(0.0, normal.dot(kFillLamp));
  const double gloss = kGloss * to_the_32nd(std::max(0.0, normal.dot(kHalfway)));
  const Rgb& paint = is_dark(uv, checks) ? kDarkCheck : kLightCheck;
  Rgb colour;
  for (std::size_t part = 0; part < 3; ++part) {
    const double lit = paint[part] * light * (look.is_inside ? kInside : 1) + 255 * gloss;
    colour[part] = static_cast<std::uint8_t>(std::lround(std::clamp(lit, 0.0, 255.0)));
  }
  return colour;
}

}  // namespace unwrapd
