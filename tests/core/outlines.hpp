#pragma once
// Outlines to pack.

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

/// On this thread alone.
inline pack::PackResult pack_alone(std::span<const charts::Outline> islands,
                                   const pack::PageOptions& page = {},
                                   const std::stop_token& stop = {}) {
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  return pack::pack(islands, page, job);
}

}  // namespace unwrapd::shapes
