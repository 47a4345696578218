#include "core/guarantee/promise.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/base/error.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd {
namespace {

using shapes::disk_of;
using shapes::from_above;

UvMap solved(const Disk& disk) {
  SerialExecutor serial;
  const UnwrapOptions options;
  return Solver(disk, options, {}, serial).run(0, {}).uv;
}

void expect_kept(const Chart& chart, const Kept& kept, Guarantee guarantee) {
  std::set<Index> faces;
  for (const KeptPart& part : kept.parts) {
    EXPECT_TRUE(flipped_faces(part.chart->mesh.faces, part.uv).empty());
    EXPECT_TRUE(guarantee != Guarantee::bijective ||
                overlapping_pairs(part.chart->mesh.faces, part.uv, 1).empty());
    faces.insert(part.chart->face_source.begin(), part.chart->face_source.end());
  }
  EXPECT_EQ(faces.size(), chart.mesh.faces.size());
  EXPECT_EQ(std::size_t(kept.mending.parts), kept.parts.size());
}

/// Flat, but wound up by more than a turn in the plane.
TriMesh spiral() {
  return shapes::mapped_grid(60, 2, shapes::Wrap::none, [](double u, double v) {
    const double r = 2 - v, angle = 8 * u;
    return Vec3(r * std::cos(angle), r * std::sin(angle), 0.5 * u);
  });
}

TEST(Promise, OfNothingLeavesTheMapAsItIs) {
  const auto owned = disk_of(shapes::grid(4, 4));
  UvMap uv = from_above(owned.disk);
  std::swap(uv[0], uv[12]);
  const Kept kept = keep_promise(owned.chart, owned.disk, uv, {.guarantee = Guarantee::none});
  ASSERT_EQ(kept.parts.size(), 1U);
  EXPECT_EQ(kept.parts[0].uv, uv);
  EXPECT_EQ(kept.mending.flips, 0);
}

TEST(Promise, OfNoFlipsIsKeptAndTellsItsPrice) {
  for (RepairMethod repair : {RepairMethod::untangle, RepairMethod::virtual_boundary}) {
    const auto owned = disk_of(shapes::grid(12, 12));
    UvMap uv = from_above(owned.disk);
    uv[6 * 13 + 6] += Vec2(0.2, 0.05);
    const auto flips = flipped_faces(owned.disk.faces, uv).size();
    ASSERT_GT(flips, 0U);
    const Kept kept = keep_promise(owned.chart, owned.disk, uv, {.repair = repair});
    expect_kept(*owned.chart, kept, Guarantee::flip_free);
    EXPECT_EQ(std::size_t(kept.mending.flips), flips);
    EXPECT_EQ(kept.mending.parts, 1);
    EXPECT_EQ(kept.mending.virtual_boundary, repair == RepairMethod::virtual_boundary);
    EXPECT_LT(kept.mending.energy_rise, 0.5);
  }
}

TEST(Promise, OfInjectivityPartsAStripThatLiesOnItselfAndSplitsItOnlyWhereThatIsTooDear) {
  const auto owned = disk_of(spiral());
  UvMap uv = from_above(owned.disk);
  if (!flipped_faces(owned.disk.faces, uv).empty())
    for (Vec2& u : uv) u.x() = -u.x();
  ASSERT_TRUE(flipped_faces(owned.disk.faces, uv).empty());
  const Kept loose = keep_promise(owned.chart, owned.disk, uv, {});
  EXPECT_EQ(loose.parts.size(), 1U);
  EXPECT_EQ(loose.parts[0].uv, uv);
  const Kept kept = keep_promise(owned.chart, owned.disk, uv, {.guarantee = Guarantee::bijective});
  expect_kept(*owned.chart, kept, Guarantee::bijective);
  EXPECT_EQ(std::size_t(kept.mending.overlaps),
            overlapping_pairs(owned.disk.faces, uv, 1 << 20).size());
  EXPECT_GT(kept.mending.overlaps, 0);
  EXPECT_GT(kept.mending.energy_rise, 0);
  EXPECT_EQ(kept.parts.size(), 1U);
  for (const double share : {0.9, 1.1}) {
    const Promise dear{.guarantee = Guarantee::bijective,
                       .most_rise = share * kept.mending.energy_rise};
    const Kept again = keep_promise(owned.chart, owned.disk, uv, dear);
    expect_kept(*owned.chart, again, Guarantee::bijective);
    EXPECT_EQ(again.parts.size() > 1, share < 1);
  }
}

TEST(Promise, TellsOfNoRiseWhereTheEnergyFell) {
  const auto owned = disk_of(spiral());
  UvMap uv = from_above(owned.disk);
  if (!flipped_faces(owned.disk.faces, uv).empty())
    for (Vec2& u : uv) u.x() = -u.x();
  for (Vec2& u : uv) u *= 3;  // far from the least energy
  for (const OwnEnergy own : {OwnEnergy::fit, OwnEnergy::symmetric_dirichlet, OwnEnergy::mips}) {
    Promise promise{.guarantee = Guarantee::bijective};
    promise.intent.own = own;
    const Kept kept = keep_promise(owned.chart, owned.disk, uv, promise);
    expect_kept(*owned.chart, kept, Guarantee::bijective);
    ASSERT_GT(kept.mending.overlaps, 0);
    EXPECT_GE(kept.mending.energy_rise, 0);
    EXPECT_LT(kept.mending.energy_rise, own == OwnEnergy::mips ? 0.05 : 1e-9);
  }
}

/// A tube that no convex map draws in double precision, with two ears on its rim.
struct EaredTube {
  static constexpr Index kAround = 8, kRings = 90, kRim = 1 + (kRings - 1) * kAround;
  TriMesh mesh;
  UvMap uv;  ///< without flips, but with one ear on the other

  EaredTube() {
    mesh = shapes::polar_disk(kAround, kRings, shapes::kTurn, [this](double r, double phi) {
      uv.emplace_back(r * std::cos(phi), r * std::sin(phi));
      return Vec3(std::min(1.0, kRings * r) * std::cos(phi),
                  std::min(1.0, kRings * r) * std::sin(phi), kRings * r);
    });
    add_ear(0, uv[kRim + 2] * 3);
    add_ear(1, uv[kRim] * 3);
  }

  void add_ear(Index k, const Vec2& tip) {
    mesh.faces.push_back({kRim + k + 1, kRim + k, mesh.vertex_count()});
    mesh.positions.push_back(mesh.positions[std::size_t(kRim + k)] + Vec3(0.3, 0.3, 1));
    uv.push_back(tip);
  }
};

TEST(Promise, OfInjectivitySplitsWhereNoMapWithoutOverlapsIsFound) {
  const EaredTube tube;
  const auto owned = disk_of(tube.mesh);
  ASSERT_TRUE(flipped_faces(owned.disk.faces, tube.uv).empty());
  ASSERT_EQ(overlapping_pairs(owned.disk.faces, tube.uv, 9).size(), 1U);
  const Kept kept =
      keep_promise(owned.chart, owned.disk, tube.uv, {.guarantee = Guarantee::bijective});
  expect_kept(*owned.chart, kept, Guarantee::bijective);
  EXPECT_EQ(kept.mending.overlaps, 1);
  EXPECT_EQ(kept.parts.size(), 2U);
}

TEST(Promise, OfInjectivityLaysANewMapWhereSpringsDrawIt) {
  const auto owned = disk_of(spiral());
  UvMap uv = from_above(owned.disk);
  if (!flipped_faces(owned.disk.faces, uv).empty())
    for (Vec2& u : uv) u.x() = -u.x();
  Promise promise{.guarantee = Guarantee::bijective};
  const auto n = Index(uv.size());
  promise.intent.springs = {{0, Vec2(3, 7), 1}, {n / 2, Vec2(3, 8), 1}, {n - 1, Vec2(3, 9), 1}};
  const Kept kept = keep_promise(owned.chart, owned.disk, uv, promise);
  expect_kept(*owned.chart, kept, Guarantee::bijective);
  ASSERT_EQ(kept.parts.size(), 1U);
  Vec2 mean = Vec2::Zero();
  for (const Spring& spring : promise.intent.springs)
    mean += kept.parts[0].uv[std::size_t(spring.vertex)] / 3;
  EXPECT_NEAR((mean - Vec2(3, 8)).norm(), 0, 1e-9);
}

TEST(Promise, FailsWhereAChartUnderSpringsWouldHaveToBeSplit) {  // parts have no place on the page
  const EaredTube tube;
  const auto owned = disk_of(tube.mesh);
  Promise promise{.guarantee = Guarantee::bijective};
  promise.intent.springs = {{0, Vec2(0, 0), 1}, {5, Vec2(1, 0), 1}};
  try {
    keep_promise(owned.chart, owned.disk, tube.uv, promise);
    FAIL() << "split a chart under springs";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::guarantee_failed);
  }
}

TEST(Promise, IsKeptOnEveryRandomDisk) {
  for (unsigned seed = 0; seed < 14; ++seed) {
    SCOPED_TRACE(seed);
    const auto owned = disk_of(shapes::random_disk(Index(2 + seed % 9), seed));
    const UvMap uv = shapes::shaken(from_above(owned.disk), 0.02 * seed, seed);
    for (Guarantee guarantee : {Guarantee::flip_free, Guarantee::bijective})
      expect_kept(*owned.chart, keep_promise(owned.chart, owned.disk, uv, {.guarantee = guarantee}),
                  guarantee);
  }
}

TEST(Promise, FailsWhereHeldVerticesBreakIt) {
  const auto owned = disk_of(shapes::grid(2, 2));
  UvMap uv = from_above(owned.disk);
  std::swap(uv[0], uv[8]);
  Promise promise;
  promise.intent.held.assign(uv.size(), 1);
  try {
    keep_promise(owned.chart, owned.disk, uv, promise);
    FAIL() << "kept what cannot be kept";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::guarantee_failed);
  }
}

TEST(Promise, IsKeptOnRealMeshes) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  for (const char* name : {"paper/Isis_dABF.obj", "paper/Beetle_ABF.obj", "paper/Balls.obj",
                           "paper/Cow_dABF.obj", "disk/hand_lowres.obj"}) {
    SCOPED_TRACE(name);
    const auto owned = disk_of(read_obj(test_data() / name));
    const UvMap uv = solved(owned.disk);
    for (Guarantee guarantee : {Guarantee::flip_free, Guarantee::bijective}) {
      const Kept kept = keep_promise(owned.chart, owned.disk, uv, {.guarantee = guarantee});
      expect_kept(*owned.chart, kept, guarantee);
      EXPECT_EQ(kept.mending.parts, 1);
    }
  }
}

}  // namespace
}  // namespace unwrapd
