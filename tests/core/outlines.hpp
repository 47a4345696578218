#pragma once
// Outlines to pack, and brute force to see where they lie.

#include <algorithm>
#include <cmath>
#include <random>

#include "core/charts/outline.hpp"
#include "core/pack/pack.hpp"

namespace unwrapd::shapes {

inline charts::Outline polygon(const UvMap& points) {
  charts::Outline outline;
  for (std::size_t k = 0; k < points.size(); ++k)
    outline.push_back({points[k], points[(k + 1) % points.size()]});
  return outline;
}

inline charts::Outline square(double side, const Vec2& at = Vec2::Zero()) {
  return polygon({at, at + Vec2(side, 0), at + Vec2(side, side), at + Vec2(0, side)});
}

inline charts::Outline star(std::mt19937& rng) {
  std::uniform_real_distribution<double> share(0.3, 1), size(-1.5, 1.5);
  const double radius = std::exp(size(rng));
  UvMap points;
  for (int k = 0; k < 12; ++k) {
    const double angle = M_PI * k / 6, r = radius * share(rng);
    points.emplace_back(3 + r * std::cos(angle), r * std::sin(angle) - 5);
  }
  return polygon(points);
}

inline std::vector<charts::Outline> stars(int count, unsigned seed) {
  std::mt19937 rng(seed);
  std::vector<charts::Outline> islands;
  for (int k = 0; k < count; ++k) islands.push_back(star(rng));
  return islands;
}

/// A net of a box as a staircase, turned by the angle: its smallest rectangle lies aslant.
inline charts::Outline net(double a, double b, double angle) {
  const UvMap corners{{0, 0},         {2 * a, 0},     {2 * a, b},     {3 * a, b},
                      {3 * a, 2 * b}, {4 * a, 2 * b}, {4 * a, 3 * b}, {2 * a, 3 * b},
                      {2 * a, 2 * b}, {a, 2 * b},     {a, b},         {0, b}};
  UvMap turned;
  for (const Vec2& p : corners)
    turned.emplace_back(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                        std::sin(angle) * p.x() + std::cos(angle) * p.y());
  return polygon(turned);
}

/// Signed.
inline double area(const charts::Outline& outline) {
  double twice = 0;
  for (const auto& [a, b] : outline) twice += a.x() * b.y() - a.y() * b.x();
  return twice / 2;
}

/// The outline where its placement puts it.
inline charts::Outline placed(charts::Outline outline, const pack::Placement& placement) {
  for (auto& side : outline)
    for (Vec2& p : side) p = placement(p);
  return outline;
}

inline double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

inline bool contains(const charts::Outline& outline, const Vec2& p) {
  bool odd = false;
  for (const auto& [a, b] : outline)
    if ((a.y() > p.y()) != (b.y() > p.y()))
      odd ^= p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
  return odd;
}

/// Between two simple polygons, from their corners: exact where they do not overlap.
inline double gap(const charts::Outline& one, const charts::Outline& other) {
  double least = 1e300;
  for (const auto& [p, q] : one)
    for (const auto& [a, b] : other)
      least = std::min({least, distance(p, a, b), distance(a, p, q)});
  return contains(one, other.front()[0]) || contains(other, one.front()[0]) ? 0 : least;
}

/// On this thread alone.
inline pack::PackResult pack_alone(std::span<const charts::Outline> islands,
                                   const pack::PageOptions& page = {},
                                   const std::stop_token& stop = {}) {
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  return pack::pack(islands, page, job);
}

}  // namespace unwrapd::shapes
