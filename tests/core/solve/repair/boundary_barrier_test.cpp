// The barrier between boundaries by its formula over all pairs, its derivatives by differences.
#include "core/solve/repair/boundary_barrier.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/mesh/edges.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::from_above;
using shapes::OwnedDisk;

/// A disk with holes, its map drawn together so that many boundaries are near each other.
UvMap crowded(const Disk& disk, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> shake(-0.03, 0.03);
  UvMap uv = from_above(disk);
  for (Vec2& u : uv) u = Vec2(0.2 * u.x() + shake(rng), u.y() + shake(rng));
  return uv;
}

double energy_of(const BoundaryBarrier& barrier, const UvMap& uv) {
  return contact_energy(barrier.contacts(uv), uv);
}

double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  double least = std::min((p - a).norm(), (p - b).norm());
  const Vec2 along = (b - a).normalized();
  const double at = (p - a).dot(along);
  if (at > 0 && at < (b - a).norm())
    least = std::min(least, std::abs(along.x() * (p - a).y() - along.y() * (p - a).x()));
  return least;
}

/// The energy of an annulus whose boundary edges are all of the length that it is given with.
double energy_by_all_pairs(const Disk& disk, const UvMap& uv) {
  double energy = 0;
  for (const BoundaryLoop& own : disk.loops)
    for (std::size_t i = 0; i < own.size(); ++i) {
      const Index v = start_of(disk.faces, own[i]);
      const auto length = [&](Index h) {
        return (disk.positions[start_of(disk.faces, h)] - disk.positions[end_of(disk.faces, h)])
            .norm();
      };
      const double near = std::min(length(own[i]), length(own[(i + own.size() - 1) % own.size()]));
      double area = 0;
      for (std::size_t t = 0; t < disk.faces.size(); ++t)
        for (Index corner : disk.faces[t]) area += corner == v ? disk.rest[t].area : 0;
      for (const BoundaryLoop& loop : disk.loops)
        for (Index h : loop) {
          const Index a = start_of(disk.faces, h), b = end_of(disk.faces, h);
          if (a == v || b == v) continue;
          const double q = std::min(near, length(h)) / 4 / distance(uv[v], uv[a], uv[b]);
          if (q > 1) energy += area * (q - 1) * (q - 1);
        }
    }
  return energy;
}

TEST(BoundaryBarrier, IsItsFormulaOverAllPairs) {
  const OwnedDisk d = disk_of(shapes::pierced_disk(12, 5));
  const BoundaryBarrier barrier(d.disk);
  for (unsigned seed = 0; seed < 10; ++seed) {
    const UvMap uv = crowded(d.disk, seed);
    ASSERT_GT(barrier.contacts(uv).size(), 20U);
    const double expected = energy_by_all_pairs(d.disk, uv);
    EXPECT_NEAR(energy_of(barrier, uv), expected, 1e-9 * expected);
  }
}

TEST(BoundaryBarrier, IsNothingWhereTheMapIsTheSurface) {
  const OwnedDisk d = disk_of(shapes::annulus(24, 4));
  EXPECT_TRUE(BoundaryBarrier(d.disk).contacts(from_above(d.disk)).empty());
}

TEST(BoundaryBarrier, HasTheSlopeOfItsDifferences) {
  const OwnedDisk d = disk_of(shapes::pierced_disk(12, 5));
  const BoundaryBarrier barrier(d.disk);
  UvMap uv = crowded(d.disk, 3);
  std::vector<Vec2> gradient(uv.size(), Vec2::Zero());
  add_contact_gradient(barrier.contacts(uv), uv, gradient);
  for (std::size_t v = 0; v < uv.size(); ++v)
    for (int axis : {0, 1}) {
      constexpr double h = 1e-8;
      const double at = uv[v][axis];
      uv[v][axis] = at + h;
      const double above = energy_of(barrier, uv);
      uv[v][axis] = at - h;
      const double below = energy_of(barrier, uv);
      uv[v][axis] = at;
      const double slope = gradient[v][axis];
      EXPECT_NEAR(slope, (above - below) / (2 * h), 1e-4 * (1 + std::abs(slope))) << v;
    }
}

TEST(BoundaryBarrier, IsBentNoMoreThanItsCurvature) {
  const std::vector<Contact> contact{{0, {1, 2}, 1, 0.5}};
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> place(-0.4, 0.4);
  for (int k = 0; k < 200; ++k) {
    UvMap uv{Vec2(place(rng), 0.5 + place(rng)), Vec2(-0.3, 0), Vec2(0.3, 0)};
    const linear::PairElement bend = contact_curvature(contact.front(), uv);
    const Vec2 way(place(rng), place(rng));
    const double h = 1e-4, at = contact_energy(contact, uv);
    double around = -2 * at;
    for (double sign : {-1.0, 1.0}) {
      UvMap moved = uv;
      moved[0] += sign * h * way;
      around += contact_energy(contact, moved);
    }
    const double bound = way.x() * way.x() * bend[0][0] + 2 * way.x() * way.y() * bend[1][0] +
                         way.y() * way.y() * bend[1][1];
    EXPECT_LE(around / (h * h), bound * (1 + 1e-3) + 1e-6);
  }
}

TEST(BoundaryBarrier, IsBentAsItsDifferencesWhereTheEdgeMovesAcrossItself) {
  const std::vector<Contact> contact{{0, {1, 2}, 1, 0.5}};
  const UvMap uv{Vec2(0.1, 0.4), Vec2(-0.3, 0), Vec2(0.5, 0)};
  const linear::PairElement bend = contact_curvature(contact.front(), uv);
  const std::array<double, 3> way{1, 0.5, 0.5};  // v of the vertex and of both ends: no turn
  const double h = 1e-4;
  double around = -2 * contact_energy(contact, uv), bound = 0;
  for (double sign : {-1.0, 1.0}) {
    UvMap moved = uv;
    for (std::size_t i = 0; i < 3; ++i) moved[i].y() += sign * h * way[i];
    around += contact_energy(contact, moved);
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      bound += way[i] * way[k] * bend[2 * std::max(i, k) + 1][2 * std::min(i, k) + 1];
  EXPECT_NEAR(around / (h * h), bound, 1e-4 * bound);
}

TEST(BoundaryBarrier, FindsWhatIsNearBeforeItActs) {
  const OwnedDisk d = disk_of(shapes::pierced_disk(12, 5));
  const BoundaryBarrier barrier(d.disk);
  const UvMap uv = crowded(d.disk, 3);
  const auto acting = barrier.contacts(uv), near = barrier.contacts(uv, 2);
  EXPECT_GT(near.size(), acting.size());
  EXPECT_EQ(contact_energy(near, uv), contact_energy(acting, uv));
}

TEST(BoundaryBarrier, GrowsWithoutBound) {
  const std::vector<Contact> contact{{0, {1, 2}, 1, 1}};
  for (double d : {1e-3, 1e-6, 1e-9}) {
    const UvMap uv{Vec2(0.1, d), Vec2(-1, 0), Vec2(1, 0)};
    EXPECT_NEAR(contact_energy(contact, uv) * d * d, 1, 3e-3);
  }
}

}  // namespace
}  // namespace unwrapd::solve::repair
