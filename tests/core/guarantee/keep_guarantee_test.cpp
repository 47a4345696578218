#include "core/guarantee/keep_guarantee.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/base/error.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::guarantee {
namespace {

using shapes::disk_of;
using shapes::from_above;

UvMap solved(const solve::Disk& disk) {
  SerialExecutor serial;
  const UnwrapOptions options;
  return solve::Solver(disk, options, {}, serial).run(0, {}).uv;
}

void expect_kept(const charts::Chart& chart, const GuaranteedMap& kept, Guarantee guarantee) {
  std::set<Index> faces;
  for (const GuaranteedPart& part : kept.parts) {
    EXPECT_TRUE(measure::flipped_faces(part.chart->mesh.faces, part.uv).empty());
    EXPECT_TRUE(guarantee != Guarantee::bijective ||
                measure::overlapping_pairs(part.chart->mesh.faces, part.uv, 1).empty());
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

TEST(GuaranteeRules, OfNothingLeavesTheMapAsItIs) {
  const auto owned = disk_of(shapes::grid(4, 4));
  UvMap uv = from_above(owned.disk);
  std::swap(uv[0], uv[12]);
  const GuaranteedMap kept =
      keep_guarantee(owned.chart, owned.disk, uv, {.guarantee = Guarantee::none});
  ASSERT_EQ(kept.parts.size(), 1U);
  EXPECT_EQ(kept.parts[0].uv, uv);
  EXPECT_EQ(kept.mending.flips, 0);
}

TEST(GuaranteeRules, OfNoFlipsIsKeptAndTellsItsPrice) {
  for (RepairMethod repair : {RepairMethod::untangle, RepairMethod::virtual_boundary}) {
    const auto owned = disk_of(shapes::grid(12, 12));
    UvMap uv = from_above(owned.disk);
    uv[6 * 13 + 6] += Vec2(0.2, 0.05);
    const auto flips = measure::flipped_faces(owned.disk.faces, uv).size();
    ASSERT_GT(flips, 0U);
    const GuaranteedMap kept = keep_guarantee(owned.chart, owned.disk, uv, {.repair = repair});
    expect_kept(*owned.chart, kept, Guarantee::flip_free);
    EXPECT_EQ(std::size_t(kept.mending.flips), flips);
    EXPECT_EQ(kept.mending.parts, 1);
    EXPECT_EQ(kept.mending.virtual_boundary, repair == RepairMethod::virtual_boundary);
    EXPECT_LT(kept.mending.energy_rise, 0.5);
  }
}

TEST(GuaranteeRules, OfInjectivityPartsAStripThatLiesOnItselfAndSplitsItOnlyWhereThatIsTooDear) {
  const auto owned = disk_of(spiral());
  UvMap uv = from_above(owned.disk);
  if (!measure::flipped_faces(owned.disk.faces, uv).empty())
    for (Vec2& u : uv) u.x() = -u.x();
  ASSERT_TRUE(measure::flipped_faces(owned.disk.faces, uv).empty());
  const GuaranteedMap loose = keep_guarantee(owned.chart, owned.disk, uv, {});
  EXPECT_EQ(loose.parts.size(), 1U);
  EXPECT_EQ(loose.parts[0].uv, uv);
  const GuaranteedMap kept =
      keep_guarantee(owned.chart, owned.disk, uv, {.guarantee = Guarantee::bijective});
  expect_kept(*owned.chart, kept, Guarantee::bijective);
  EXPECT_EQ(std::size_t(kept.mending.overlaps),
            measure::overlapping_pairs(owned.disk.faces, uv, 1 << 20).size());
  EXPECT_GT(kept.mending.overlaps, 0);
  EXPECT_GT(kept.mending.energy_rise, 0);
  EXPECT_EQ(kept.parts.size(), 1U);
  for (const double share : {0.9, 1.1}) {
    const GuaranteeRules dear{.guarantee = Guarantee::bijective,
                              .most_rise = share * kept.mending.energy_rise};
    const GuaranteedMap again = keep_guarantee(owned.chart, owned.disk, uv, dear);
    expect_kept(*owned.chart, again, Guarantee::bijective);
    EXPECT_EQ(again.parts.size() > 1, share < 1);
  }
}

TEST(GuaranteeRules, TellsOfNoRiseWhereTheEnergyFell) {
  const auto owned = disk_of(spiral());
  UvMap uv = from_above(owned.disk);
  if (!measure::flipped_faces(owned.disk.faces, uv).empty())
    for (Vec2& u : uv) u.x() = -u.x();
  for (Vec2& u : uv) u *= 3;  // far from the least energy
  for (const solve::repair::OwnEnergy own :
       {solve::repair::OwnEnergy::fit, solve::repair::OwnEnergy::symmetric_dirichlet,
        solve::repair::OwnEnergy::mips}) {
    GuaranteeRules rules{.guarantee = Guarantee::bijective};
    rules.intent.own = own;
    const GuaranteedMap kept = keep_guarantee(owned.chart, owned.disk, uv, rules);
    expect_kept(*owned.chart, kept, Guarantee::bijective);
    ASSERT_GT(kept.mending.overlaps, 0);
    EXPECT_GE(kept.mending.energy_rise, 0);
    EXPECT_LT(kept.mending.energy_rise, own == solve::repair::OwnEnergy::mips ? 0.05 : 1e-9);
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

TEST(GuaranteeRules, OfInjectivitySplitsWhereNoMapWithoutOverlapsIsFound) {
  const EaredTube tube;
  const auto owned = disk_of(tube.mesh);
  ASSERT_TRUE(measure::flipped_faces(owned.disk.faces, tube.uv).empty());
  ASSERT_EQ(measure::overlapping_pairs(owned.disk.faces, tube.uv, 9).size(), 1U);
  const GuaranteedMap kept =
      keep_guarantee(owned.chart, owned.disk, tube.uv, {.guarantee = Guarantee::bijective});
  expect_kept(*owned.chart, kept, Guarantee::bijective);
  EXPECT_EQ(kept.mending.overlaps, 1);
  EXPECT_EQ(kept.parts.size(), 2U);
}

TEST(GuaranteeRules, OfInjectivityLaysANewMapWhereSpringsDrawIt) {
  const auto owned = disk_of(spiral());
  UvMap uv = from_above(owned.disk);
  if (!measure::flipped_faces(owned.disk.faces, uv).empty())
    for (Vec2& u : uv) u.x() = -u.x();
  GuaranteeRules rules{.guarantee = Guarantee::bijective};
  const auto n = Index(uv.size());
  rules.intent.soft = {{0, Vec2(3, 7), 1}, {n / 2, Vec2(3, 8), 1}, {n - 1, Vec2(3, 9), 1}};
  const GuaranteedMap kept = keep_guarantee(owned.chart, owned.disk, uv, rules);
  expect_kept(*owned.chart, kept, Guarantee::bijective);
  ASSERT_EQ(kept.parts.size(), 1U);
  Vec2 mean = Vec2::Zero();
  for (const solve::SoftConstraint& soft_constraint : rules.intent.soft)
    mean += kept.parts[0].uv[std::size_t(soft_constraint.vertex)] / 3;
  EXPECT_NEAR((mean - Vec2(3, 8)).norm(), 0, 1e-9);
}

TEST(GuaranteeRules,
     FailsWhereAChartUnderSpringsWouldHaveToBeSplit) {  // parts have no place on the page
  const EaredTube tube;
  const auto owned = disk_of(tube.mesh);
  GuaranteeRules rules{.guarantee = Guarantee::bijective};
  rules.intent.soft = {{0, Vec2(0, 0), 1}, {5, Vec2(1, 0), 1}};
  try {
    keep_guarantee(owned.chart, owned.disk, tube.uv, rules);
    FAIL() << "split a chart under springs";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::guarantee_failed);
  }
}

TEST(GuaranteeRules, IsKeptOnEveryRandomDisk) {
  for (unsigned seed = 0; seed < 14; ++seed) {
    SCOPED_TRACE(seed);
    const auto owned = disk_of(shapes::random_disk(Index(2 + seed % 9), seed));
    const UvMap uv = shapes::shaken(from_above(owned.disk), 0.02 * seed, seed);
    for (Guarantee guarantee : {Guarantee::flip_free, Guarantee::bijective})
      expect_kept(*owned.chart,
                  keep_guarantee(owned.chart, owned.disk, uv, {.guarantee = guarantee}), guarantee);
  }
}

TEST(GuaranteeRules, FailsWhereHeldVerticesBreakIt) {
  const auto owned = disk_of(shapes::grid(2, 2));
  UvMap uv = from_above(owned.disk);
  std::swap(uv[0], uv[8]);
  GuaranteeRules rules;
  rules.intent.constrained.assign(uv.size(), 1);
  try {
    keep_guarantee(owned.chart, owned.disk, uv, rules);
    FAIL() << "kept what cannot be kept";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::guarantee_failed);
  }
}

TEST(GuaranteeRules, IsKeptOnRealMeshes) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  for (const char* name : {"paper/Isis_dABF.obj", "paper/Beetle_ABF.obj", "paper/Balls.obj",
                           "paper/Cow_dABF.obj", "disk/hand_lowres.obj"}) {
    SCOPED_TRACE(name);
    const auto owned = disk_of(read_obj(test_data() / name));
    const UvMap uv = solved(owned.disk);
    for (Guarantee guarantee : {Guarantee::flip_free, Guarantee::bijective}) {
      const GuaranteedMap kept =
          keep_guarantee(owned.chart, owned.disk, uv, {.guarantee = guarantee});
      expect_kept(*owned.chart, kept, guarantee);
      EXPECT_EQ(kept.mending.parts, 1);
    }
  }
}

}  // namespace
}  // namespace unwrapd::guarantee
