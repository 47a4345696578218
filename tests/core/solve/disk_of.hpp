#pragma once
// A mesh that is one disk, ready for the solver, for tests.

#include <memory>
#include <random>
#include <span>
#include <utility>

#include "core/charts/charts.hpp"
#include "core/solve/base/disk.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::shapes {

/// Owns the chart that its disk looks into.
struct OwnedDisk {
  std::shared_ptr<charts::Chart> chart;
  solve::Disk disk;
};

inline OwnedDisk disk_of(TriMesh mesh) {
  charts::Charts charts = charts::make_charts(surface_of(std::move(mesh)), SeamMode::keep);
  if (charts.charts.size() != 1) throw std::invalid_argument("not one disk");
  auto chart = std::make_shared<charts::Chart>(std::move(charts.charts.front()));
  solve::Disk disk = solve::make_disk(chart->mesh, chart->loops);
  return {std::move(chart), std::move(disk)};
}

/// The map that drops the third coordinate.
inline UvMap from_above(std::span<const Vec3> positions) {
  UvMap uv;
  for (const Vec3& p : positions) uv.emplace_back(p.x(), p.y());
  return uv;
}

/// The map with every coordinate moved by a random amount of at most `by`.
inline UvMap shaken(UvMap uv, double by, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> shake(-by, by);
  for (Vec2& u : uv) u += Vec2(shake(rng), shake(rng));
  return uv;
}

inline UvMap from_above(const solve::Disk& disk) { return from_above(disk.positions); }

}  // namespace unwrapd::shapes
