// A three-quarter view is what one would choose by hand: it shows depth, and a terrain as well as a
// bust. Principal axes were tried first: they look straight onto a flat side, and turn a figure
// upside down or leave it lying.
#include "core/figure/view.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace unwrapd::figure {
namespace {

/// In the order of preference.
constexpr std::array<Aspect, 14> kAspects = {{{30, 20},
                                              {-30, 20},
                                              {30, 50},
                                              {150, 20},
                                              {-150, 20},
                                              {90, 20},
                                              {-90, 20},
                                              {150, 50},
                                              {-30, 50},
                                              {-150, 50},
                                              {30, -30},
                                              {150, -30},
                                              {-30, -50},
                                              {-150, -50}}};
struct NamedAspect {
  std::string_view name;
  Aspect aspect;
};
constexpr std::array<NamedAspect, 6> kNamed = {{{"front", {0, 0}},
                                                {"back", {180, 0}},
                                                {"left", {-90, 0}},
                                                {"right", {90, 0}},
                                                {"top", {0, 90}},
                                                {"bottom", {0, -90}}}};
constexpr double kNearlyBest = 0.9;   // of the best view's area
constexpr double kFillOfView = 0.92;  // of the picture's side

void look_from(const Aspect& aspect, View& view) {
  const double a = aspect.azimuth * std::numbers::pi / 180;
  const double e = aspect.elevation * std::numbers::pi / 180;
  view.toward = {std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)};
  view.right = {std::cos(a), 0, -std::sin(a)};  // also where one looks along Y
  view.up = view.toward.cross(view.right);
}

template <class Visit>
void for_each_face(std::span<const Surface> surfaces, Visit visit) {
  for (const Surface& surface : surfaces)
    for (const auto& [a, b, c] : surface.mesh.faces)
      visit(surface.mesh.positions[a], surface.mesh.positions[b], surface.mesh.positions[c]);
}

double greatest_coordinate(std::span<const Surface> surfaces) {
  double greatest = 0;
  for_each_face(surfaces, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const Vec3* p : {&a, &b, &c}) greatest = std::max(greatest, p->cwiseAbs().maxCoeff());
  });
  return greatest > 0 ? greatest : 1;
}

/// Area of the surfaces' outer sides as seen from each aspect.
std::array<double, kAspects.size()> shown_areas(std::span<const Surface> surfaces, double unit) {
  std::array<View, kAspects.size()> views;
  for (std::size_t k = 0; k < kAspects.size(); ++k) look_from(kAspects[k], views[k]);
  std::array<double, kAspects.size()> areas{};
  for_each_face(surfaces, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 normal = (b / unit - a / unit).cross(c / unit - a / unit);
    for (std::size_t k = 0; k < areas.size(); ++k)
      areas[k] += std::max(0.0, normal.dot(views[k].toward));
  });
  return areas;
}

const Aspect& best_aspect(std::span<const Surface> surfaces, double unit) {
  const auto areas = shown_areas(surfaces, unit);
  const double enough = kNearlyBest * *std::ranges::max_element(areas);
  std::size_t k = 0;
  while (k + 1 < areas.size() && areas[k] < enough) ++k;
  return kAspects[k];
}

}  // namespace

Vec2 View::pixel(const Vec3& position) const {
  const Vec3 p = position / unit;
  const Vec2 offset = pixels * (Vec2(right.dot(p), up.dot(p)) - middle);
  return {centre + offset.x(), centre - offset.y()};
}

double View::depth(const Vec3& position) const { return pixels * toward.dot(position / unit); }

std::optional<Aspect> aspect_named(std::string_view name) {
  const auto found = std::ranges::find(kNamed, name, &NamedAspect::name);
  return found == kNamed.end() ? std::nullopt : std::optional(found->aspect);
}

View view_of(std::span<const Surface> surfaces, int size, const std::optional<Aspect>& aspect) {
  View view;
  view.unit = greatest_coordinate(surfaces);
  view.centre = size / 2.0;
  look_from(aspect ? *aspect : best_aspect(surfaces, view.unit), view);
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::max()), high = -low;
  for_each_face(surfaces, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const Vec3* p : {&a, &b, &c}) {
      const Vec2 at(view.right.dot(*p / view.unit), view.up.dot(*p / view.unit));
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
  });
  const double side = (high - low).maxCoeff();
  if (!(side >= 0)) return view;
  view.middle = (low + high) / 2;
  view.extent = side > 0 ? kFillOfView * size : 0;
  view.pixels = side > 0 ? view.extent / side : 1;
  return view;
}

}  // namespace unwrapd::figure
