// Surfaces whose isometric or ARAP map lies on itself, mapped without an overlap.
#include "core/solve/repair/bijective.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/methods/symmetric_dirichlet.hpp"
#include "core/solve/repair/boundary_barrier.hpp"
#include "core/solve/repair/injective_step.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::kTurn;
using shapes::OwnedDisk;

UvMap solved(const Disk& disk) {
  SerialExecutor serial;
  return Solver(disk, UnwrapOptions(), {}, serial).run(0, {}).uv;
}

std::size_t overlaps(const Disk& disk, const UvMap& uv) {
  return measure::overlapping_pairs(disk.faces, uv, 1 << 20).size();
}

/// A ramp of more than one turn around a hollow axis: nearly developable, onto a ring that covers
/// itself.
TriMesh ramp(Index along, Index across, double turns) {
  return shapes::mapped_grid(along, across, shapes::Wrap::none, [&](double u, double v) {
    const double angle = kTurn * turns * u, radius = 1 + 0.5 * (1 - v);
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.4 * turns * u);
  });
}

void expect_injective(const Disk& disk, const UvMap& uv, double most_energy) {
  EXPECT_TRUE(measure::flipped_faces(disk.faces, uv).empty());
  EXPECT_EQ(overlaps(disk, uv), 0U);
  SerialExecutor serial;
  EXPECT_LT(methods::symmetric_dirichlet_energy(disk, uv, serial), most_energy);
}

TEST(Bijective, PartsARampThatLiesOnItself) {
  for (double turns : {1.2, 1.6, 2.5}) {
    SCOPED_TRACE(turns);
    const OwnedDisk d = disk_of(ramp(Index(60 * turns), 4, turns));
    UvMap uv = solved(d.disk);
    ASSERT_GT(overlaps(d.disk, uv), 0U);
    ASSERT_TRUE(map_injectively(d.disk, {}, uv));
    expect_injective(d.disk, uv, 4.5);  // 4 is isometric
  }
}

/// The least distance of a boundary vertex from a boundary edge, in reaches of the barrier.
double least_gap(const Disk& disk, const UvMap& uv) {
  double least = 1;
  for (const Contact& contact : BoundaryBarrier(disk).contacts(uv)) {
    Contact alone = contact;
    alone.weight = 1;
    const double excess = std::sqrt(contact_energy(std::span(&alone, 1), uv));
    least = std::min(least, 1 / (1 + excess));
  }
  return least;
}

TEST(Bijective, LeavesAGapBetweenBoundariesThatPress) {
  const OwnedDisk d = disk_of(ramp(150, 4, 2.5));
  UvMap uv = solved(d.disk);
  ASSERT_TRUE(map_injectively(d.disk, {}, uv));
  EXPECT_LT(least_gap(d.disk, uv), 1);
  EXPECT_GT(least_gap(d.disk, uv), 0.25);
}

TEST(Bijective, EndsWithTheEnergyThatIsAskedFor) {
  const OwnedDisk d = disk_of(shapes::sphere_cap(24, 12, 2));
  UvMap rigid(d.disk.positions.size(), Vec2::Zero()), conformal = rigid;
  ASSERT_TRUE(map_injectively(d.disk, {}, rigid));
  ASSERT_TRUE(map_injectively(d.disk, {.rigidity = {.lambda = 0}, .constrained = {}, .stop = {}},
                              conformal));
  const auto angle = [&](const UvMap& uv) {
    return measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, uv)).angle - 2;
  };
  EXPECT_LT(angle(conformal), 0.25 * angle(rigid));
}

TEST(Bijective, KeepsHolesOpen) {
  const OwnedDisk d = disk_of(shapes::pierced_disk(12, 5));
  UvMap uv = solved(d.disk);
  ASSERT_TRUE(map_injectively(d.disk, {}, uv));
  expect_injective(d.disk, uv, 4.5);
}

TEST(Bijective, LaysAFlatSurfaceWhereItWas) {
  const OwnedDisk d = disk_of(shapes::grid(9, 7, 1.5, 1));
  UvMap turned;
  for (const Vec3& p : d.disk.positions)
    turned.emplace_back(3 + 0.6 * p.x() - 0.8 * p.y(), 0.8 * p.x() + 0.6 * p.y() - 2);
  UvMap uv = turned;
  ASSERT_TRUE(map_injectively(d.disk, {}, uv));
  for (std::size_t v = 0; v < uv.size(); ++v) EXPECT_LT((uv[v] - turned[v]).norm(), 0.02) << v;
}

TEST(Bijective, IsDrawnByItsSprings) {
  const OwnedDisk d = disk_of(shapes::grid(9, 7, 1.5, 1));
  UvMap uv = solved(d.disk), turned;
  for (const Vec3& p : d.disk.positions)
    turned.emplace_back(3 + 0.6 * p.x() - 0.8 * p.y(), 0.8 * p.x() + 0.6 * p.y() - 2);
  MapIntent intent;
  for (const std::size_t v : {0U, 9U, 44U, 79U}) intent.soft.push_back({Index(v), turned[v], 1});
  ASSERT_TRUE(map_injectively(d.disk, intent, uv));
  for (std::size_t v = 0; v < uv.size(); ++v) EXPECT_LT((uv[v] - turned[v]).norm(), 0.02) << v;
}

TEST(Bijective, IsStretchedByStrongSprings) {
  const OwnedDisk d = disk_of(shapes::grid(9, 7, 1.5, 1));
  UvMap uv = solved(d.disk);
  MapIntent intent;
  for (const std::size_t v : {0U, 9U, 70U, 79U})
    intent.soft.push_back({Index(v), 1.2 * d.disk.positions[v].head<2>(), 1e4});
  ASSERT_TRUE(map_injectively(d.disk, intent, uv));
  for (const SoftConstraint& soft_constraint : intent.soft)
    EXPECT_LT((uv[std::size_t(soft_constraint.vertex)] - soft_constraint.at).norm(), 0.01)
        << soft_constraint.vertex;
}

TEST(Bijective, GivesTheSameBytesAgain) {
  const OwnedDisk d = disk_of(ramp(90, 6, 1.5));
  const UvMap before = solved(d.disk);
  UvMap once = before, again = before;
  ASSERT_TRUE(map_injectively(d.disk, {}, once));
  ASSERT_TRUE(map_injectively(d.disk, {}, again));
  EXPECT_EQ(once, again);
}

TEST(Bijective, StopsWhenAsked) {
  const OwnedDisk d = disk_of(ramp(60, 4, 1.5));
  UvMap uv = solved(d.disk);
  const UvMap before = uv;
  std::stop_source source;
  source.request_stop();
  try {
    map_injectively(d.disk, {.rigidity = {}, .constrained = {}, .stop = source.get_token()}, uv);
    FAIL() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(uv, before);
}

/// A tube of 90 rings: Tutte's shrink by a factor each.
TriMesh long_tube() {
  return shapes::polar_disk(5, 90, kTurn, [](double r, double phi) {
    const double radius = std::min(1.0, 90 * r);
    return Vec3(radius * std::cos(phi), radius * std::sin(phi), 90 * r);
  });
}

TEST(Bijective, BeginsFromTheMapThatIsGivenWhereThatIsInjective) {
  const OwnedDisk d = disk_of(long_tube());
  UvMap rings;
  for (const Vec3& p : shapes::polar_disk(5, 90, kTurn, [](double r, double phi) {
                         return Vec3(r * std::cos(phi), r * std::sin(phi), 0);
                       }).positions)
    rings.push_back(p.head<2>());
  UvMap uv = rings;
  EXPECT_TRUE(map_injectively(d.disk, {}, uv, rings));
  EXPECT_TRUE(measure::is_plainly_injective(d.disk.faces, d.disk.loops, uv));
  const UvMap collapsed(rings.size(), Vec2::Zero());
  EXPECT_FALSE(map_injectively(d.disk, {}, uv, collapsed));
}

TEST(Bijective, LeavesTheMapWhereNoStartIsInjectiveInDoublePrecision) {
  const OwnedDisk d = disk_of(long_tube());
  UvMap uv(d.disk.positions.size(), Vec2(1, 2));
  const UvMap before = uv;
  EXPECT_FALSE(map_injectively(d.disk, {}, uv));
  EXPECT_EQ(uv, before);
}

TEST(Bijective, MapsEveryHardDisk) {
  for (const auto& [name, mesh] : shapes::hard_disks()) {
    SCOPED_TRACE(name);
    const OwnedDisk d = disk_of(mesh);
    UvMap uv(d.disk.positions.size(), Vec2::Zero());
    if (map_injectively(d.disk, {}, uv))
      EXPECT_TRUE(measure::is_plainly_injective(d.disk.faces, d.disk.loops, uv));
    else
      ADD_FAILURE() << "no start";
  }
}

TEST(Bijective, MapsRealMeshesThatLieOnThemselves) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  for (const char* name : {"paper/Beetle_ABF.obj", "paper/Cow_dABF.obj"}) {
    SCOPED_TRACE(name);
    const OwnedDisk d = disk_of(read_obj(test_data() / name));
    UvMap uv = solved(d.disk);
    ASSERT_GT(overlaps(d.disk, uv), 0U);
    ASSERT_TRUE(map_injectively(d.disk, {}, uv));
    expect_injective(d.disk, uv, 4.6);
  }
}

TEST(InjectiveStep, EndsFourFifthsOfTheWayToTheFirstFlip) {
  const OwnedDisk d = disk_of(shapes::grid(1, 1));
  const UvMap start = shapes::from_above(d.disk);
  std::vector<Vec2> step(start.size(), Vec2::Zero());
  step[0] = 3 * (start.back() - start.front());  // the farther the better, until it flips
  const auto energy = [&](const UvMap& uv) {
    const bool is_flipped = !measure::flipped_faces(d.disk.faces, uv).empty();
    return is_flipped ? std::numeric_limits<double>::infinity() : -uv[0].dot(step[0]);
  };
  SerialExecutor serial;
  const double flip = methods::step_to_flip(d.disk, start, step, serial);
  ASSERT_LT(flip, 1);
  UvMap uv = start;
  ASSERT_TRUE(injective_step(d.disk, step, -step[0].squaredNorm(), energy, uv));
  EXPECT_LT((uv[0] - start[0] - 0.8 * flip * step[0]).norm(), 1e-12);
}

}  // namespace
}  // namespace unwrapd::solve::repair
