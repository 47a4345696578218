#include "core/solve/repair/press_apart.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/repair/overlap_area.hpp"
#include "core/solve/solve.hpp"
#include "tests/bench/opened_body.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::kTurn;

std::vector<Index> own_ranks(const Disk& disk) {
  std::vector<Index> rank(disk.positions.size());
  std::iota(rank.begin(), rank.end(), 0);
  return rank;
}

double area_of(OverlapArea& overlap, const UvMap& uv) {
  std::vector<Vec2> force(uv.size(), Vec2::Zero());
  return overlap.evaluate(uv, 0, force);
}

/// The unit square as a strip two units wide that runs on a circle of radius 4, by so many turns.
UvMap wound(const Disk& disk, double turns) {
  UvMap uv = shapes::from_above(disk);
  for (Vec2& p : uv) {
    const double angle = kTurn * turns * (p.x() + .5), r = 4 - 2 * p.y();
    p = {r * std::cos(angle), r * std::sin(angle)};
  }
  return uv;
}

TEST(OverlapArea, IsWhatTwoSheetsCoverTwice) {
  const auto owned = disk_of(shapes::grid(80, 2));
  OverlapArea overlap(owned.disk, own_ranks(owned.disk), 0);
  const double ring = kTurn / 2 * (25 - 9);
  EXPECT_NEAR(area_of(overlap, wound(owned.disk, 0.9)), 0, 1e-9);
  for (const double turns : {1.1, 1.3, 1.8})
    EXPECT_NEAR(area_of(overlap, wound(owned.disk, turns)), (turns - 1) * ring, 0.02 * ring)
        << turns;
  // three sheets are three pairs, where there is a third turn
  EXPECT_NEAR(area_of(overlap, wound(owned.disk, 2.2)), (0.8 + 3 * 0.2) * ring, 0.04 * ring);
}

TEST(OverlapArea, SeesWhatIsNearerThanTheGap) {
  const auto owned = disk_of(shapes::grid(80, 2));
  const UvMap apart = wound(owned.disk, 0.99);
  OverlapArea narrow(owned.disk, own_ranks(owned.disk), 0.01);
  OverlapArea wide(owned.disk, own_ranks(owned.disk), 0.5);
  EXPECT_NEAR(area_of(narrow, apart), 0, 1e-9);
  EXPECT_GT(area_of(wide, apart), 0.1);
}

TEST(OverlapArea, ForcesAgainstItsOwnGradient) {
  const auto owned = disk_of(shapes::grid(80, 2));
  OverlapArea overlap(owned.disk, own_ranks(owned.disk), 0);
  const UvMap uv = wound(owned.disk, 1.313);
  std::vector<Vec2> force(uv.size(), Vec2::Zero());
  overlap.evaluate(uv, 2, force);
  double largest = 0;
  for (std::size_t v = 0; v < uv.size(); ++v)
    for (int k = 0; k < 2; ++k) {
      const double step = 1e-5;
      UvMap more = uv, less = uv;
      more[v][k] += step;
      less[v][k] -= step;
      const double slope = (area_of(overlap, more) - area_of(overlap, less)) / (2 * step);
      EXPECT_NEAR(force[v][k], -2 * slope, 1e-4) << v;
      largest = std::max(largest, std::abs(slope));
    }
  EXPECT_GT(largest, 0.1);
}

UvMap arap_of(const Disk& disk) {
  SerialExecutor serial;
  UvMap uv = Solver(disk, UnwrapOptions{}, {}, serial).run(0, {}).uv;
  untangle(disk, {}, uv);
  return uv;
}

double fit_energy(const Disk& disk, const UvMap& uv) {
  double energy = 0;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    const measure::Jacobian j =
        measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv));
    const double a = j.sigma_max() - 1, b = j.sigma_min() - 1;
    energy += disk.rest[t].area * (a * a + b * b);
  }
  return energy;
}

TEST(PressApart, PartsSheetsAtLittleEnergyOrLeavesTheMap) {
  int overlapping = 0, parted = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const auto owned = disk_of(bench::opened_body(1200 + 60 * seed, seed));
    const UvMap uv = arap_of(owned.disk);
    if (measure::overlapping_pairs(owned.disk.faces, uv, 1).empty()) continue;
    ++overlapping;
    UvMap apart = uv;
    constexpr double kMost = 0.1;
    if (!press_apart(owned.disk, {}, kMost, apart)) {
      EXPECT_EQ(apart, uv);
      continue;
    }
    ++parted;
    EXPECT_TRUE(measure::flipped_faces(owned.disk.faces, apart).empty());
    EXPECT_TRUE(measure::overlapping_pairs(owned.disk.faces, apart, 1).empty());
    EXPECT_LT(fit_energy(owned.disk, apart), (1.01 + kMost) * fit_energy(owned.disk, uv));
  }
  EXPECT_GE(overlapping, 8);
  EXPECT_GE(parted, 3);
  EXPECT_LT(parted, overlapping);
}

}  // namespace
}  // namespace unwrapd::solve::repair
