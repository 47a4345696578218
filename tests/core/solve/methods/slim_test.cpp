// SLIM: never a flip, never a rise, from the best start to where no small change helps.
#include "core/solve/methods/slim.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "core/solve/methods/symmetric_dirichlet.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/odd_disks.hpp"
#include "tests/core/solve/similarity.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve::methods {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

Solution solved(const Disk& disk, const SolveWatch& watch = {}, const Stop& stop = {}) {
  SerialExecutor serial;
  return slim(disk, stop, watch, serial);
}

double energy_of(const Disk& disk, const UvMap& uv) {
  SerialExecutor serial;
  return symmetric_dirichlet_energy(disk, uv, serial);
}

/// Every map on the way is free of flips, by an exact test, and none costs more than the last.
void expect_guarantee_kept(const Disk& disk, const std::string& what) {
  std::vector<double> told;
  const Solution s = solved(
      disk, {.on_stage = {},
             .loop = {.on_iteration =
                          [&](const Solution& so_far) {
                            EXPECT_TRUE(measure::flipped_faces(disk.faces, so_far.uv).empty())
                                << what;
                            told.push_back(so_far.energy.back());
                          },
                      .stop = {}}});
  ASSERT_EQ(s.energy.size(), std::size_t(s.iterations) + 1) << what;
  ASSERT_EQ(told.size() + 1, s.energy.size()) << what;
  for (std::size_t k = 1; k < s.energy.size(); ++k) EXPECT_LE(s.energy[k], s.energy[k - 1]) << what;
  EXPECT_GE(s.energy.back(), 4 * 0.999) << what;
  EXPECT_TRUE(measure::flipped_faces(disk.faces, s.uv).empty()) << what;
}

TEST(Slim, KeepsItsPromiseOnRandomDisks) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const OwnedDisk d = disk_of(shapes::random_disk(Index(1 + seed), seed));
    expect_guarantee_kept(d.disk, std::to_string(seed));
  }
}

TEST(Slim, KeepsItsPromiseAroundHoles) {
  for (const TriMesh& mesh : {shapes::cylinder(12, 8), shapes::pierced_disk(9, 2),
                              shapes::pierced_disk(17, 3), shapes::annulus(9, 2)}) {
    const OwnedDisk d = disk_of(mesh);
    expect_guarantee_kept(d.disk, std::to_string(mesh.faces.size()));
  }
}

TEST(Slim, KeepsItsPromiseOnHardDisks) {
  for (const auto& [name, mesh] : odd::hard_disks()) {
    const OwnedDisk d = disk_of(mesh);
    expect_guarantee_kept(d.disk, name);
  }
}

// The far end of the tube is smaller than a double can be.
TEST(Slim, SaysWhatToDoWhereNoStartIsFreeOfFlips) {
  const OwnedDisk d = disk_of(shapes::cylinder(12, 400, 1, 400));
  try {
    solved(d.disk);
    FAIL() << "an answer";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::solver_failed);
    EXPECT_NE(std::string(e.what()).find("choose another method"), std::string::npos) << e.what();
  }
}

double energy_at_best_scale(const Disk& disk, const UvMap& uv) {
  double least = std::numeric_limits<double>::infinity();
  for (double scale = 0.05; scale < 20; scale *= 1.02) {
    UvMap scaled = uv;
    for (Vec2& u : scaled) u *= scale;
    least = std::min(least, energy_of(disk, scaled));
  }
  return least;
}

TEST(Slim, StartsNoWorseThanAnyConvexMapAtAnyScale) {
  for (const TriMesh& mesh : {shapes::sphere_cap(24, 10, 2.6), shapes::random_disk(12, 4)}) {
    const OwnedDisk d = disk_of(mesh);
    const double start = solved(d.disk).energy.front();
    EXPECT_LE(start, energy_at_best_scale(d.disk, maps::tutte_map(d.disk)));
    EXPECT_LE(start, energy_at_best_scale(d.disk, maps::mean_value_map(d.disk)));
  }
}

TEST(Slim, ClosesHolesForItsStart) {  // left open they spread: 9.7 against 19 on this tube
  const OwnedDisk d = disk_of(shapes::cylinder(20, 10));
  const double start = solved(d.disk).energy.front();
  EXPECT_LT(1.5 * start, energy_at_best_scale(d.disk, maps::tutte_map(d.disk)));
  EXPECT_LT(1.5 * start, energy_at_best_scale(d.disk, maps::mean_value_map(d.disk)));
}

TEST(Slim, IsIsometricOnDevelopableDisks) {
  for (const TriMesh& mesh : {shapes::grid(7, 5, 2, 1), shapes::half_cylinder(16, 8),
                              shapes::cone_sector(20, 6), shapes::annulus(24, 4, 0.3)}) {
    const OwnedDisk d = disk_of(mesh);
    const Solution s = solved(d.disk);
    EXPECT_NEAR(s.energy.back(), 4, 1e-9);
    const Distortion got =
        measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, s.uv));
    EXPECT_NEAR(got.angle, 2, 1e-9);
    EXPECT_NEAR(got.area, 2, 1e-9);
  }
}

TEST(Slim, GoesFourFifthsOfTheWayToTheFirstFlipAndNoFarther) {
  double nearest = std::numeric_limits<double>::infinity();  // the flip, in units of a step
  for (const auto& shape : odd::hard_disks()) {
    const OwnedDisk d = disk_of(shape.mesh);
    UvMap before;
    const auto look = [&](const Solution& s) {
      UvMap step = s.uv;
      for (std::size_t v = 0; v < before.size(); ++v) step[v] -= before[v];
      SerialExecutor serial;
      if (!before.empty()) nearest = std::min(nearest, step_to_flip(d.disk, before, step, serial));
      before = s.uv;
    };
    solved(d.disk, {.on_stage = {}, .loop = {look, {}}});
  }
  EXPECT_NEAR(nearest, 1 / 0.8, 1e-6);
}

TEST(Slim, EndsWhereNoSmallChangeHelps) {
  const OwnedDisk d = disk_of(shapes::random_disk(8, 7));
  const Solution s = solved(d.disk);
  EXPECT_EQ(s.stop_reason, StopReason::converged);
  std::mt19937 rng(8);
  std::normal_distribution<double> normal;
  for (double size : {1e-2, 1e-3})
    for (int k = 0; k < 20; ++k) {
      UvMap other = s.uv;
      for (Vec2& u : other) u += size / 8 * Vec2(normal(rng), normal(rng));
      EXPECT_GT(energy_of(d.disk, other), s.energy.back());
    }
}

TEST(Slim, EndsAfterAsManyIterationsAsWereAskedFor) {
  const OwnedDisk d = disk_of(shapes::random_disk(14, 7));
  const Solution whole = solved(d.disk);
  ASSERT_GT(whole.iterations, 5);
  for (int most : {1, 4}) {
    const Solution plain = solved(d.disk, {}, {.iterations = most});
    const Solution cut = solved(d.disk, {}, {.max_iterations = most});
    EXPECT_EQ(plain.iterations, most);
    EXPECT_EQ(plain.stop_reason, StopReason::iterations);
    EXPECT_EQ(cut.iterations, most);
    EXPECT_EQ(cut.stop_reason, StopReason::max_iterations);
    EXPECT_EQ(plain.energy.back(), whole.energy[std::size_t(most)]);
    EXPECT_EQ(cut.uv, plain.uv);
  }
  const Solution on = solved(d.disk, {}, {.iterations = whole.iterations + 1, .tolerance = 0.1});
  EXPECT_EQ(on.iterations, whole.iterations + 1);  // no tolerance ends what was counted out
  EXPECT_EQ(on.stop_reason, StopReason::iterations);
}

TEST(Slim, StopsTheLaterTheSmallerTheTolerance) {
  const OwnedDisk d = disk_of(shapes::random_disk(14, 7));
  int iterations = 0;
  for (double tolerance : {1e-1, 1e-3, 1e-6, 1e-11}) {
    const Solution s = solved(d.disk, {}, {.tolerance = tolerance});
    EXPECT_EQ(s.stop_reason, StopReason::converged);
    EXPECT_GT(s.iterations, iterations);
    iterations = s.iterations;
    for (int k = 1; k <= iterations; ++k) {  // the first fall that is small enough is the last
      const double before = s.energy[std::size_t(k) - 1], now = s.energy[std::size_t(k)];
      EXPECT_EQ(before - now <= tolerance * before, k == iterations) << tolerance << ' ' << k;
    }
  }
}

TEST(Slim, HasConvergedWhereNothingIsLeftToGain) {
  const OwnedDisk d = disk_of(shapes::grid(4, 4));
  const Solution s = solved(d.disk, {}, {.iterations = 400});
  EXPECT_LT(s.iterations, 400);
  EXPECT_EQ(s.stop_reason, StopReason::converged);
}

TEST(Slim, DoesNotDependOnScaleOrPlace) {
  const TriMesh mesh = shapes::random_disk(10, 3);
  const OwnedDisk d = disk_of(mesh);
  const Solution expected = solved(d.disk);
  for (double scale : {1e-6, 1e6}) {
    TriMesh other = mesh;
    for (Vec3& p : other.positions) p = scale * (p + Vec3(100, -200, 300));
    const OwnedDisk e = disk_of(std::move(other));
    const Solution got = solved(e.disk);
    EXPECT_LT(gap_up_to_similarity(got.uv, expected.uv), 1e-6) << scale;
    EXPECT_NEAR(got.energy.back(), expected.energy.back(), 1e-9) << scale;
  }
}

TEST(Slim, IsTheSameBytesForTwoThreads) {
  const OwnedDisk d = disk_of(shapes::random_disk(50, 9));
  TwoThreads two;
  const Solution a = solved(d.disk), b = slim(d.disk, {}, {}, two);
  EXPECT_EQ(a.uv, b.uv);
  EXPECT_EQ(a.energy, b.energy);
}

TEST(Slim, StopsWithinAnIterationOfBeingAskedTo) {
  const OwnedDisk d = disk_of(shapes::sphere_cap(20, 8, 2));
  std::stop_source source;
  int told = 0;
  const auto stop_at_three = [&](const Solution&) {
    if (++told == 3) source.request_stop();
  };
  try {
    solved(d.disk, {.on_stage = {}, .loop = {stop_at_three, source.get_token()}});
    FAIL() << "not cancelled";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(told, 3);
}

TEST(Slim, ReachesWhatLibiglReachesOnTheModelsOfThePaper) {
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  const std::vector<std::tuple<std::string, double, double>> peer{
      {"Isis_dABF", 2.156, 2.088}, {"Balls", 2.075, 2.045}, {"Beetle_ABF", 2.013, 2.011}};
  for (const auto& [name, angle, area] : peer) {
    const OwnedDisk d = disk_of(read_obj(test_data() / "paper" / (name + ".obj")));
    const Solution s = solved(d.disk);
    const Distortion got =
        measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, s.uv));
    EXPECT_NEAR(got.angle, angle, 0.002) << name;
    EXPECT_NEAR(got.area, area, 0.002) << name;
    EXPECT_EQ(s.stop_reason, StopReason::converged) << name;
  }
}

}  // namespace
}  // namespace unwrapd::solve::methods
