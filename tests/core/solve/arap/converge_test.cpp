// The accelerated iterations and the starts they are given: promises on energies and iterations.
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/solve/arap/initial_rotations.hpp"
#include "core/solve/base/align_constrained.hpp"
#include "core/solve/maps/conformal.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/counting_executor.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/cancel_at.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/folded.hpp"
#include "tests/core/solve/ranks.hpp"
#include "tests/core/solve/similarity.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve::arap {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

Solution solved(const Disk& disk, const UnwrapOptions& options, const SolveWatch& watch = {}) {
  SerialExecutor serial;
  return Solver(disk, options, {}, serial).run(options.lambda, watch);
}

std::vector<TriMesh> curved_disks() {
  return {shapes::sphere_cap(24, 8, 1.5), shapes::random_disk(12, 3), shapes::annulus(20, 4),
          shapes::cylinder(16, 6), shapes::pierced_bar(3)};
}

void expect_never_rises(const std::vector<double>& energy) {
  for (std::size_t k = 1; k < energy.size(); ++k) EXPECT_LE(energy[k], energy[k - 1]) << k;
}

/// A paper model with the lowest energy over area that any peer reached.
struct PaperModel {
  const char* file;
  double energy;
};
constexpr PaperModel kPaper[] = {{"Gargoyle_ABF.obj", .04214},
                                 {"Isis_dABF.obj", .13421},
                                 {"Balls.obj", .06391},
                                 {"Cow_dABF.obj", .01313},
                                 {"Beetle_ABF.obj", .01051}};

TEST(Converge, EveryStartReachesTheLowestEnergiesKnown) {
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  for (const PaperModel& model : kPaper)
    for (InitialMap start :
         {InitialMap::automatic, InitialMap::mean_value, InitialMap::tutte, InitialMap::lscm}) {
      const OwnedDisk d = disk_of(read_obj(test_data() / "paper" / model.file));
      const Solution s = solved(d.disk, {.initial = start});
      EXPECT_LT(s.energy.back(), model.energy * 1.001) << model.file;
      EXPECT_LE(s.iterations, 250) << model.file;
      EXPECT_EQ(s.stop_reason, StopReason::converged);
      EXPECT_NEAR(s.energy.back(), measure::arap_energy(d.disk.rest, d.disk.faces, s.uv), 1e-12);
      expect_never_rises(s.energy);
    }
}

TEST(Converge, ReachesTheMinimumOfManyPlainIterations) {
  for (const TriMesh& mesh : curved_disks())
    for (Method method : {Method::arap, Method::hybrid}) {
      const OwnedDisk d = disk_of(mesh);
      UnwrapOptions options{.method = method, .lambda = 0.8, .initial = InitialMap::lscm};
      const double fast = solved(d.disk, options).energy.back();
      options.stop.iterations = 4000;
      const double slow = solved(d.disk, options).energy.back();
      EXPECT_NEAR(fast, slow, 1e-5 * slow + 1e-12);
    }
}

TEST(Converge, EnergyNeverRisesAndIterationsAreTold) {
  for (const TriMesh& mesh : curved_disks())
    for (double lambda : {0.05, 0.5, 5.0, std::numeric_limits<double>::infinity()}) {
      const OwnedDisk d = disk_of(mesh);
      std::vector<double> told;
      SolveWatch watch;
      watch.loop.on_iteration = [&](const Solution& s) {
        told.push_back(s.energy.back());
        EXPECT_EQ(s.iterations, int(told.size()));
        EXPECT_EQ(s.energy.size(), told.size() + 1);
      };
      const Solution s = solved(d.disk, {.method = Method::hybrid, .lambda = lambda}, watch);
      if (s.stop_reason == StopReason::direct) continue;
      EXPECT_EQ(s.iterations, int(told.size()));
      EXPECT_EQ(std::vector(s.energy.begin() + 1, s.energy.end()), told);
      expect_never_rises(s.energy);
    }
}

TEST(Converge, UnfoldsDevelopableShapes) {
  for (const TriMesh& mesh :
       {shapes::hilbert_wall(5, 1, 4, 4), shapes::hilbert_wall(5, 2, 8, 4),
        shapes::hilbert_ribbon(4, 2, 1.5), shapes::hilbert_ribbon(6, 2, 1.5),
        shapes::pierced_roll(56, 5), shapes::cone_sector(40, 20), shapes::half_cylinder(60, 9)}) {
    const OwnedDisk d = disk_of(mesh);
    const Solution s = solved(d.disk, {});
    EXPECT_LT(s.energy.back(), 1e-8);
    EXPECT_EQ(measure::distortion_sums(d.disk.rest, d.disk.faces, s.uv).flipped, 0);
    EXPECT_EQ(s.stop_reason, StopReason::converged);
    EXPECT_LE(s.iterations, 5);  // rounding is not descended into
  }
}

TEST(Converge, KeepsMaxIterations) {
  const OwnedDisk d = disk_of(shapes::pierced_bar(3));  // long enough for a second start
  const Solution whole = solved(d.disk, {});
  for (int most : {1, 2, 7, 16, 17, 18, 30}) {
    const Solution s = solved(d.disk, {.stop = {.max_iterations = most}});
    EXPECT_EQ(s.iterations, most);
    EXPECT_EQ(s.stop_reason, StopReason::max_iterations);
    EXPECT_EQ(s.energy.size(), std::size_t(most) + 1);
    EXPECT_TRUE(std::equal(s.energy.begin(), s.energy.end(), whole.energy.begin()));
  }
}

TEST(Converge, StopsTheLaterTheSmallerTheTolerance) {
  const OwnedDisk d = disk_of(shapes::random_disk(14, 2));
  int iterations = 0;
  double energy = 1;
  for (double tolerance : {1e-2, 1e-4, 1e-6, 1e-10}) {
    const Solution s = solved(d.disk, {.stop = {.tolerance = tolerance}});
    EXPECT_GT(s.iterations, iterations);
    EXPECT_LE(s.energy.back(), energy);
    iterations = s.iterations, energy = s.energy.back();
    const double fell = s.energy[s.energy.size() - 11] - energy;  // over the last ten
    EXPECT_LE(fell, tolerance * energy);
  }
}

TEST(Converge, CancelsWithinOneIteration) {
  const OwnedDisk d = disk_of(shapes::pierced_bar(3));
  for (int last : {1, 5, 16, 17})  // 16 is followed by a second start, 17 is the change to it
    expect_cancelled_at(last, [&](const SolveWatch& watch) { solved(d.disk, {}, watch); });
}

TEST(Converge, GivesTheSameBytesOnOneAndTwoThreads) {
  const OwnedDisk d = disk_of(shapes::random_disk(70, 4));  // 5,041 vertices: two blocks
  SerialExecutor one;
  TwoThreads two;
  const UnwrapOptions options{};
  const Solution a = Solver(d.disk, options, {}, one).run(0, {});
  const Solution b = Solver(d.disk, options, {}, two).run(0, {});
  EXPECT_EQ(a.uv, b.uv);
  EXPECT_EQ(a.energy, b.energy);
}

TEST(Converge, HeldVerticesStayAndTheOthersComeToRest) {
  const OwnedDisk d = disk_of(shapes::random_disk(12, 8));
  VertexConstraints constraints{.hard = {{3, {-.7, 0}}, {100, {.5, .4}}},
                                .soft = {{60, {.1, .1}, 2}}};
  const ConstrainedStart constrained{
      constraints, constrained_start(maps::conformal_map(d.disk, Pins::diameter), constraints)};
  SerialExecutor serial;
  const UnwrapOptions options{.stop = {.tolerance = 1e-13}};
  const Solution s = Solver(d.disk, options, constrained, serial).run(0, {});
  expect_never_rises(s.energy);
  EXPECT_EQ(s.uv[3], constraints.hard[0].at);
  EXPECT_EQ(s.uv[100], constraints.hard[1].at);
  EXPECT_NEAR(s.energy.back(),
              measure::arap_energy(d.disk.rest, d.disk.faces, s.uv) +
                  soft_constraint_energy(constraints, s.uv),
              1e-12);
  std::vector<Vec2> force(s.uv.size());
  Objective(d.disk, {}, constraints, shapes::as_listed(force.size()), serial).evaluate(s.uv, force);
  for (const Vec2& f : force) EXPECT_LT(f.norm(), 1e-6);
}

TEST(Converge, HybridDoesNotRememberOtherLambdas) {
  const OwnedDisk d = disk_of(shapes::cylinder(16, 6));
  const UnwrapOptions options{.method = Method::hybrid};
  SerialExecutor serial;
  Solver reused(d.disk, options, {}, serial);
  for (double lambda : {3.0, 0.01, 0.3, 0.0, 3.0, 0.3})
    EXPECT_EQ(reused.run(lambda, {}).uv, Solver(d.disk, options, {}, serial).run(lambda, {}).uv);
}

TEST(Converge, SmallLambdasKeepTheAreaOfTheConformalMap) {
  std::vector<TriMesh> meshes = curved_disks();
  if (!test_data().empty()) meshes.push_back(read_obj(test_data() / "paper" / "Isis_dABF.obj"));
  for (const TriMesh& mesh : meshes) {
    const OwnedDisk d = disk_of(mesh);
    const UvMap asap = solved(d.disk, {.method = Method::asap}).uv;
    const double c = measure::asap_energy(d.disk.rest, d.disk.faces, asap);
    for (double lambda : {c * .4, c * .51, c * .6, c, 1e-6, 1e-4, 1e-2}) {
      const Solution s = solved(d.disk, {.method = Method::hybrid, .lambda = lambda});
      EXPECT_GE(measure::uv_area(d.disk.rest, d.disk.faces, s.uv),
                0.01 * measure::uv_area(d.disk.rest, d.disk.faces, asap));
    }
  }
}

TEST(Starts, AutomaticEndsAsLowAsTheBestOfAll) {
  std::vector<TriMesh> meshes = curved_disks();
  if (!test_data().empty())
    for (const char* file : {"paper/Cow_dABF.obj", "paper/Beetle_ABF.obj", "disk/hand_lowres.obj"})
      meshes.push_back(read_obj(test_data() / file));
  for (const TriMesh& mesh : meshes) {
    const OwnedDisk d = disk_of(mesh);
    double least = 1e300;
    for (InitialMap kind : {InitialMap::mean_value, InitialMap::tutte, InitialMap::lscm})
      least = std::min(least, solved(d.disk, {.initial = kind}).energy.back());
    EXPECT_LE(solved(d.disk, {}).energy.back(), least * 1.001 + 1e-12);
  }
}

TEST(Starts, ASecondStartFindsALowerMinimum) {
  for (int windows : {3, 8}) {  // of 8, when both have gone a little farther than at first
    const OwnedDisk d = disk_of(shapes::pierced_bar(windows));
    const double near = solved(d.disk, {.initial = InitialMap::mean_value}).energy.back();
    const Solution s = solved(d.disk, {});
    EXPECT_LT(s.energy.back(), near * 0.995) << windows;
    expect_never_rises(s.energy);
  }
}

int sweeps_of(const Disk& disk, const UnwrapOptions& options) {
  CountingExecutor executor;
  Solver(disk, options, {}, executor).run(0, {});
  return executor.sweeps;
}

TEST(Starts, AutomaticCostsAtMostHalfAgainAsMuchAsOneStart) {
  std::vector<TriMesh> meshes = curved_disks();
  meshes.push_back(shapes::pierced_bar(8));
  if (!test_data().empty()) meshes.push_back(read_obj(test_data() / "paper" / "Cow_dABF.obj"));
  for (const TriMesh& mesh : meshes) {
    const OwnedDisk d = disk_of(mesh);
    int named = 0;
    for (InitialMap start : {InitialMap::mean_value, InitialMap::tutte, InitialMap::lscm})
      named += sweeps_of(d.disk, {.initial = start});
    EXPECT_LE(sweeps_of(d.disk, {}), 1.5 * named / 3) << mesh.faces.size();
  }
}

TEST(Starts, ADescentThatIsSoonAtRestIsNotTriedTwice) {
  for (const TriMesh& mesh : {shapes::sphere_cap(24, 8, 1.5), shapes::random_disk(24, 3)}) {
    const OwnedDisk d = disk_of(mesh);
    const int iterations = solved(d.disk, {}).iterations;
    const int ten = sweeps_of(d.disk, {.stop = {.max_iterations = 10}});
    const int eleven = sweeps_of(d.disk, {.stop = {.max_iterations = 11}});
    ASSERT_GT(iterations, 11);
    const int each = eleven - ten;  // more where the last steps are halved in vain
    EXPECT_LE(sweeps_of(d.disk, {}), ten + (iterations - 10 + 3) * each);
  }
}

TEST(Starts, FramesUnfoldAConeWithItsCurvatureAtTheApex) {
  for (double height : {0.3, 1.0, 2.0}) {
    const OwnedDisk d = disk_of(shapes::cone(24, 1, height));  // one inner vertex
    const UvMap uv = map_from_rotations(d.disk, GlobalStep(d.disk, {}));
    double spread_least = 10, spread_most = 0;  // all triangles are alike, and so are their images
    for (std::size_t t = 0; t < d.disk.faces.size(); ++t) {
      const measure::Jacobian j =
          measure::jacobian(d.disk.rest[t], measure::uv_edges(d.disk.faces[t], uv));
      spread_least = std::min(spread_least, j.sigma_max());
      spread_most = std::max(spread_most, j.sigma_max());
      EXPECT_GT(j.sigma_min(), 0);
    }
    EXPECT_NEAR(spread_least, spread_most, 1e-9);
  }
}

TEST(Starts, FramesDoNotDependOnWhereTheyAreCarriedFrom) {
  TriMesh mesh = shapes::random_disk(15, 6);
  const auto frames_by_corner = [](const TriMesh& m, std::size_t first) {
    const OwnedDisk d = disk_of(m);
    const UvMap uv = map_from_rotations(d.disk, GlobalStep(d.disk, {}));
    UvMap corners;
    for (std::size_t t = 0; t < d.disk.faces.size(); ++t)
      for (Index v : d.disk.faces[(t + first) % d.disk.faces.size()])
        corners.push_back(uv[std::size_t(v)]);
    return corners;
  };
  const UvMap expected = frames_by_corner(mesh, 211);
  std::rotate(mesh.faces.begin(), mesh.faces.begin() + 211, mesh.faces.end());
  EXPECT_LT(gap_up_to_similarity(expected, frames_by_corner(mesh, 0)), 1e-9);
}

TEST(Starts, FramesAreTheSameWhetherTwinsAreKnownOrSought) {
  for (const TriMesh& mesh : {shapes::random_disk(15, 6), shapes::cone(24, 8, 2)}) {
    OwnedDisk d = disk_of(mesh);
    const GlobalStep global(d.disk, {});
    const UvMap expected = map_from_rotations(d.disk, global);
    d.disk.twin = d.chart->halfedges.twin;
    EXPECT_EQ(map_from_rotations(d.disk, global), expected);
  }
}

}  // namespace
}  // namespace unwrapd::solve::arap
