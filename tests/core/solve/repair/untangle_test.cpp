#include "core/solve/repair/untangle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/repair/patch.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::from_above;

std::size_t flips(const Disk& disk, const UvMap& uv) {
  return measure::flipped_faces(disk.faces, uv).size();
}

UvMap solved(const Disk& disk, const UnwrapOptions& options = {}) {
  SerialExecutor serial;
  return Solver(disk, options, {}, serial).run(options.lambda, {}).uv;
}

TEST(Untangle, LeavesAMapWithoutFlipsAsItIs) {
  const auto owned = disk_of(shapes::random_disk(8, 1));
  const UvMap before = solved(owned.disk);
  ASSERT_EQ(flips(owned.disk, before), 0U);
  UvMap after = before;
  EXPECT_EQ(untangle(owned.disk, {}, after), 0);
  EXPECT_EQ(after, before);
}

TEST(Untangle, TurnsOneVertexBackAndMovesOnlyItsNeighbours) {
  const auto owned = disk_of(shapes::grid(20, 20));
  const UvMap flat = from_above(owned.disk);
  UvMap uv = flat;
  const std::size_t v = 10 * 21 + 10;
  uv[v] += Vec2(0.12, 0.03);  // over its neighbour and the next
  ASSERT_GE(flips(owned.disk, uv), 2U);
  EXPECT_EQ(untangle(owned.disk, {}, uv), 0);
  EXPECT_EQ(flips(owned.disk, uv), 0U);
  for (std::size_t k = 0; k < uv.size(); ++k) {
    EXPECT_TRUE((flat[k] - flat[v]).norm() < 0.3 || uv[k] == flat[k]) << k;
  }
  EXPECT_LT(measure::arap_energy(owned.disk.rest, owned.disk.faces, uv), 1e-3);
}

TEST(Untangle, TurnsBackWhatAnyShakingFlipped) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    const auto owned = disk_of(shapes::random_disk(Index(2 + seed % 12), seed));
    UvMap uv = shapes::shaken(from_above(owned.disk), 0.02 * double(1 + seed % 10), seed);
    EXPECT_EQ(untangle(owned.disk, {}, uv), 0);
    EXPECT_EQ(flips(owned.disk, uv), 0U);
  }
}

TEST(Untangle, TurnsAWholeMirroredMapBack) {
  for (const TriMesh& mesh :
       {shapes::grid(5, 5), shapes::annulus(20, 3), shapes::sphere_cap(12, 5)}) {
    const auto owned = disk_of(mesh);
    UvMap uv = from_above(owned.disk);
    for (Vec2& u : uv) u.x() = -u.x();
    EXPECT_EQ(untangle(owned.disk, {}, uv), 0);
    EXPECT_EQ(flips(owned.disk, uv), 0U);
  }
}

TEST(Untangle, UnfoldsAFlapHoweverMuchOfTheMapItIs) {
  const auto owned = disk_of(shapes::grid(40, 40));
  for (double fold : {0.1, 0.15, 0.3, 0.5, 0.8}) {  // 2 to 92 % of the faces
    SCOPED_TRACE(fold);
    UvMap uv = from_above(owned.disk);
    for (Vec2& u : uv) {  // the corner beyond the diagonal u + v = 2 fold is folded over it
      const double beyond = (2 * fold * 0.999 - u.x() - u.y()) / 2;
      if (beyond > 0) u += 2 * beyond * Vec2(1, 1);
    }
    ASSERT_GT(flips(owned.disk, uv), 0U);
    EXPECT_EQ(untangle(owned.disk, {}, uv), 0);
    EXPECT_EQ(flips(owned.disk, uv), 0U);
    EXPECT_LT(measure::arap_energy(owned.disk.rest, owned.disk.faces, uv), 1e-3);
  }
}

TEST(Untangle, OpensAMapThatCollapsedToAPointOrALine) {
  for (const TriMesh& mesh : {shapes::random_disk(5, 2), shapes::annulus(16, 2)}) {
    const auto owned = disk_of(mesh);
    UvMap point(owned.disk.positions.size(), Vec2(0.1, 0.2));
    EXPECT_EQ(untangle(owned.disk, {}, point), 0);
    UvMap line = from_above(owned.disk);
    for (Vec2& u : line) u.y() = u.x();
    EXPECT_EQ(untangle(owned.disk, {}, line), 0);
    EXPECT_EQ(flips(owned.disk, line), 0U);
  }
}

TEST(Untangle, NeverMovesHeldVertices) {
  const auto owned = disk_of(shapes::grid(8, 8));
  UvMap uv = from_above(owned.disk);
  const std::size_t v = 4 * 9 + 4;
  MapIntent intent{.rigidity = {}, .constrained = std::vector<char>(uv.size(), 0), .stop = {}};
  uv[v] += Vec2(0.2, 0);
  intent.constrained[v] = 1;
  for (std::size_t k = 0; k < 9; ++k) intent.constrained[k] = 1;
  const UvMap before = uv;
  EXPECT_EQ(untangle(owned.disk, intent, uv), 0);
  for (std::size_t k = 0; k < uv.size(); ++k)
    EXPECT_TRUE(intent.constrained[k] == 0 || uv[k] == before[k]) << k;
}

TEST(Untangle, TurnsTrianglesBackWithinARimMuchTooSmallForThem) {
  const auto owned = disk_of(shapes::random_disk(12, 3));
  UvMap uv = solved(owned.disk);
  const Vec2 middle = uv[13 * 6 + 6];
  for (Vec2& u : uv) u = 1e-6 * (u - middle);
  MapIntent intent{.rigidity = {}, .constrained = std::vector<char>(uv.size(), 1), .stop = {}};
  for (std::size_t row = 2; row < 11; ++row)
    for (std::size_t column = 2; column < 11; ++column) {
      intent.constrained[13 * row + column] = 0;
      uv[13 * row + column].x() *= -0.5;  // mirrored
    }
  ASSERT_GT(flips(owned.disk, uv), 100U);
  EXPECT_EQ(untangle(owned.disk, intent, uv), 0);
  EXPECT_EQ(flips(owned.disk, uv), 0U);
}

TEST(Untangle, SaysSoWhereHeldVerticesLeaveNoWay) {
  const auto owned = disk_of(shapes::grid(2, 2));
  UvMap uv = from_above(owned.disk);
  const MapIntent intent{
      .rigidity = {}, .constrained = std::vector<char>(uv.size(), 1), .stop = {}};
  std::swap(uv[0], uv[8]);
  EXPECT_EQ(std::size_t(untangle(owned.disk, intent, uv)), flips(owned.disk, uv));
  EXPECT_GT(flips(owned.disk, uv), 0U);
}

TEST(Untangle, KeepsTheSizesOfAConformalMap) {
  const auto owned = disk_of(shapes::sphere_cap(40, 30, 2.9));  // scales from 1 to some hundred
  UvMap uv = solved(owned.disk, {.method = Method::asap});
  const double before = measure::asap_energy(owned.disk.rest, owned.disk.faces, uv);
  uv[0] += 3 * (uv[41] - uv[0]);
  ASSERT_GT(flips(owned.disk, uv), 0U);
  EXPECT_EQ(untangle(owned.disk, {.rigidity = {0.0}, .constrained = {}, .stop = {}}, uv), 0);
  EXPECT_LT(measure::asap_energy(owned.disk.rest, owned.disk.faces, uv), before * 1.01);
}

TEST(Untangle, StopsWhenAsked) {
  const auto owned = disk_of(shapes::grid(5, 5));
  UvMap uv = from_above(owned.disk);
  std::swap(uv[0], uv[35]);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(
      untangle(owned.disk, {.rigidity = {}, .constrained = {}, .stop = stop.get_token()}, uv),
      Error);
}

TEST(Untangle, CostsLittleEnergyOnRealMeshes) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  std::size_t turned = 0;
  for (const char* name :
       {"paper/Beetle_ABF.obj", "paper/Cow_dABF.obj", "paper/Gargoyle_ABF.obj"}) {
    const auto owned = disk_of(read_obj(test_data() / name));
    UvMap uv = solved(owned.disk);
    const double before = measure::arap_energy(owned.disk.rest, owned.disk.faces, uv);
    turned += flips(owned.disk, uv);
    EXPECT_EQ(untangle(owned.disk, {}, uv), 0);
    EXPECT_LT(measure::arap_energy(owned.disk.rest, owned.disk.faces, uv), before * 1.007) << name;
  }
  EXPECT_GT(turned, 0U) << "these meshes no longer show anything";
}

/// The worst condition of the faces that moved, by the singular values alone.
double worst_moved_condition(const Disk& disk, const UvMap& before, const UvMap& after) {
  double worst = 1;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    const Triangle& f = disk.faces[t];
    if (std::ranges::all_of(
            f, [&](Index v) { return before[std::size_t(v)] == after[std::size_t(v)]; }))
      continue;
    const measure::Jacobian j = measure::jacobian(disk.rest[t], measure::uv_edges(f, after));
    worst = std::max(worst, j.sigma_max() / j.sigma_min());
  }
  return worst;
}

TEST(Untangle, LeavesNoNeedleWhereItTurnedATriangleOver) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    const auto owned = disk_of(shapes::grid(20, 20));
    const UvMap before = shapes::shaken(from_above(owned.disk), 0.05, seed);
    ASSERT_GT(flips(owned.disk, before), 5U);
    UvMap after = before;
    EXPECT_EQ(untangle(owned.disk, {}, after), 0);
    EXPECT_LE(worst_moved_condition(owned.disk, before, after), 20);
  }
}

/// The distortion of a mended ARAP map is that of a map without needles, not that of the few
/// triangles that were turned over.
TEST(Untangle, KeepsTheDistortionOfThePapersModelsLow) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  const std::map<std::string, double> most = {
      {"Beetle_ABF", 2.0235}, {"Cow_dABF", 2.023}, {"Gargoyle_ABF", 2.051}};
  for (const auto& [name, most_angle] : most) {
    SCOPED_TRACE(name);
    const auto owned = disk_of(read_obj(test_data() / "paper" / (name + ".obj")));
    const UvMap before = solved(owned.disk);
    UvMap after = before;
    ASSERT_EQ(untangle(owned.disk, {}, after), 0);
    const Distortion d =
        measure::distortion(measure::distortion_sums(owned.disk.rest, owned.disk.faces, after));
    EXPECT_LT(d.angle, most_angle);
    EXPECT_LE(worst_moved_condition(owned.disk, before, after), 20);
  }
}

/// By any executor: patches that are apart, and the whole at once where flips are many.
TEST(Untangle, GivesTheSameMapOnAnyThreads) {
  TwoThreads two;
  for (const double shake : {0.035, 0.08}) {
    SCOPED_TRACE(shake);
    const auto owned = disk_of(shapes::grid(30, 30));
    const UvMap shaken = shapes::shaken(from_above(owned.disk), shake, 5);
    ASSERT_GT(flips(owned.disk, shaken), 3U);
    for (const double lambda : {0.0, std::numeric_limits<double>::infinity()}) {
      UvMap alone = shaken, abreast = shaken;
      EXPECT_EQ(untangle(owned.disk, {.rigidity = {lambda}, .constrained = {}, .stop = {}}, alone),
                0);
      EXPECT_EQ(untangle(owned.disk,
                         {.rigidity = {lambda}, .constrained = {}, .stop = {}, .executor = &two},
                         abreast),
                0);
      EXPECT_EQ(alone, abreast);
    }
  }
}

TEST(Untangle, UntiesAKnotWithinTwoRings) {  // where flipped triangles hold each other flat
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    const auto owned = disk_of(shapes::random_disk(40, seed));
    const UvMap flat = from_above(owned.disk);
    UvMap uv = flat;
    for (std::size_t k = 0; k < 5; ++k)
      uv[(200 + 300 * k)] += 0.06 * Vec2(std::cos(k + seed), std::sin(k + seed));
    const UvMap before = uv;
    std::vector<char> near(uv.size(), 0);  // and as far around the needles that are left
    for (const Patch& patch :
         patches_around(owned.disk, measure::flipped_faces(owned.disk.faces, uv), 5, {}))
      for (Index v : patch.vertex) near[std::size_t(v)] = 1;
    EXPECT_EQ(untangle(owned.disk, {}, uv), 0);
    for (std::size_t v = 0; v < uv.size(); ++v)
      EXPECT_TRUE(near[v] != 0 || uv[v] == before[v]) << v;
  }
}

TEST(Untangle, SettlesOnlyAroundWhatItTurnedOver) {  // many flips, on which several rounds work
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  TriMesh balls = read_obj(test_data() / "paper" / "Balls.obj");
  for (int k = 0; k < 3; ++k) balls = shapes::subdivided(balls);
  const auto owned = disk_of(std::move(balls));
  const UvMap before = solved(owned.disk, {.stop = {.iterations = 10}});
  ASSERT_GT(flips(owned.disk, before), 100U);
  UvMap after = before;
  EXPECT_EQ(untangle(owned.disk, {}, after), 0);
  EXPECT_EQ(flips(owned.disk, after), 0U);
  EXPECT_LE(measure::arap_energy(owned.disk.rest, owned.disk.faces, after),
            measure::arap_energy(owned.disk.rest, owned.disk.faces, before));
  std::size_t moved = 0;
  for (std::size_t v = 0; v < before.size(); ++v) moved += before[v] != after[v] ? 1 : 0;
  EXPECT_LT(moved, before.size() / 4);
}

}  // namespace
}  // namespace unwrapd::solve::repair
