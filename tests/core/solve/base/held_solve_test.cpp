// All three methods under holds, through Solver, and from the page to the disk and back.
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/constrain_chart.hpp"
#include "core/solve/maps/boundary_shape.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/holds_of.hpp"
#include "tests/core/solve/ranks.hpp"

namespace unwrapd::solve {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

std::vector<UnwrapOptions> all_methods(Stop stop = {}) {
  std::vector<UnwrapOptions> all{{.method = Method::asap, .stop = stop}, {.stop = stop}};
  for (double lambda : {0.0, 1e-3, 0.2, 3.0})
    all.push_back({.method = Method::hybrid, .lambda = lambda, .stop = stop});
  return all;
}

/// A chart held on the page, and how it was solved there.
struct PageSolve {
  ChartConstraints hold;
  Solution solution;
  UvMap page;
};

PageSolve solved_on_page(const Disk& disk, const UnwrapOptions& options,
                         const VertexConstraints& page) {
  SerialExecutor serial;
  PageSolve s{.hold = constrain_chart(disk, options, page, {}, serial), .solution = {}, .page = {}};
  s.solution = Solver(disk, options, s.hold.constrained, serial).run(options.lambda, {});
  s.page = s.hold.frame->to_page(s.solution.uv, page);
  return s;
}

TEST(HeldSolve, KeepsHardPinsToTheLastBitInAllMethods) {
  const OwnedDisk d = disk_of(shapes::random_disk(12, 3));
  for (std::size_t count : {1U, 2U, 3U, 50U}) {
    const VertexConstraints page{scattered(d.disk, count, 5), {}};
    for (const UnwrapOptions& options : all_methods()) {
      const PageSolve s = solved_on_page(d.disk, options, page);
      for (const HardConstraint& p : page.hard) EXPECT_EQ(s.page[std::size_t(p.vertex)], p.at);
      for (const HardConstraint& p : s.hold.constrained.constraints.hard)
        EXPECT_EQ(s.solution.uv[std::size_t(p.vertex)], p.at);
      for (const Vec2& u : s.page) EXPECT_TRUE(u.allFinite());
    }
  }
}

TEST(HeldSolve, KeepsAWholeBoundaryInAllMethods) {
  for (const TriMesh& mesh : {shapes::sphere_cap(24, 8, 1.2), shapes::annulus(24, 4)})
    for (BoundaryShape shape : {BoundaryShape::circle, BoundaryShape::square}) {
      const OwnedDisk d = disk_of(mesh);
      const auto points = maps::boundary_points(d.disk, shape);
      SerialExecutor serial;
      for (UnwrapOptions options : all_methods()) {
        options.boundary = shape;
        const ChartConstraints hold = constrain_chart(d.disk, options, {}, {}, serial);
        EXPECT_FALSE(hold.frame);
        const Solution s =
            Solver(d.disk, options, hold.constrained, serial).run(options.lambda, {});
        for (const HardConstraint& p : points) EXPECT_EQ(s.uv[std::size_t(p.vertex)], p.at);
      }
    }
}

TEST(HeldSolve, NeverRaisesTheEnergy) {
  for (const TriMesh& mesh : {shapes::random_disk(12, 3), shapes::sphere_cap(20, 8, 1.5)})
    for (const Stop& stop : {Stop{.iterations = 40}, Stop{}}) {
      const OwnedDisk d = disk_of(mesh);
      const auto points = scattered(d.disk, 20, 8);
      const VertexConstraints page{{points.begin(), points.begin() + 7},
                                   as_soft_constraints({points.begin() + 7, points.end()}, 0.5)};
      for (const UnwrapOptions& options : all_methods(stop)) {
        const std::vector<double> energy = solved_on_page(d.disk, options, page).solution.energy;
        for (std::size_t k = 1; k < energy.size(); ++k)
          EXPECT_LE(energy[k], energy[k - 1] * (1 + 1e-12) + 1e-24);
      }
    }
}

TEST(HeldSolve, EndsWhereTheForceIsZero) {
  const OwnedDisk d = disk_of(shapes::random_disk(10, 4));
  const auto points = scattered(d.disk, 12, 2);
  const VertexConstraints page{{points.begin(), points.begin() + 4},
                               as_soft_constraints({points.begin() + 4, points.end()}, 0.5)};
  const Stop stop{.tolerance = 1e-13, .max_iterations = 3000};
  SerialExecutor serial;
  for (const UnwrapOptions& options : all_methods(stop)) {
    const PageSolve s = solved_on_page(d.disk, options, page);
    const double lambda = options.method == Method::arap
                              ? std::numeric_limits<double>::infinity()
                              : (options.method == Method::asap ? 0 : options.lambda);
    std::vector<Vec2> force(s.page.size());
    arap::Objective objective(d.disk, {lambda, false}, s.hold.constrained.constraints,
                              shapes::as_listed(force.size()), serial);
    EXPECT_NEAR(objective.evaluate(s.solution.uv, force), s.solution.energy.back(), 1e-12);
    for (const Vec2& f : force) EXPECT_LT(f.norm(), 2e-5) << "lambda " << lambda;
  }
}

TEST(HeldSolve, ApproachesHardPinsAsTheWeightGrows) {
  const OwnedDisk d = disk_of(shapes::random_disk(10, 4));
  const auto points = scattered(d.disk, 9, 2);
  for (const UnwrapOptions& options : all_methods({.tolerance = 1e-10})) {
    const UvMap hard = solved_on_page(d.disk, options, {points, {}}).page;
    double before = std::numeric_limits<double>::infinity();
    for (double weight : {0.1, 10.0, 1e3, 1e5, 1e7}) {
      const UvMap soft =
          solved_on_page(d.disk, options, {{}, as_soft_constraints(points, weight)}).page;
      double gap = 0;
      for (const HardConstraint& p : points)
        gap = std::max(gap, (soft[std::size_t(p.vertex)] - p.at).norm());
      EXPECT_LT(gap, before);
      before = gap;
      if (weight == 1e7) {
        EXPECT_LT(gap, 1e-6);
        EXPECT_LT(greatest_gap(soft, hard), 1e-3);
      }
    }
  }
}

TEST(HeldSolve, OfOnePinIsTheFreeMapMoved) {
  const OwnedDisk d = disk_of(shapes::random_disk(10, 4));
  SerialExecutor serial;
  const VertexConstraints hard{{{17, Vec2(0.3, 0.4)}}, {}}, soft{{}, {{17, Vec2(0.3, 0.4), 0.1}}};
  for (const VertexConstraints& page : {hard, soft})
    for (const UnwrapOptions& options : all_methods({.tolerance = 1e-12})) {
      const PageSolve s = solved_on_page(d.disk, options, page);
      const Solution free = Solver(d.disk, options, {}, serial).run(options.lambda, {});
      EXPECT_NEAR(s.solution.energy.back(), free.energy.back(), 1e-7);
      EXPECT_LT((s.page[17] - Vec2(0.3, 0.4)).norm(), 1e-6);
      Vec2 low = s.page[0], high = s.page[0];
      for (const Vec2& u : s.page) low = low.cwiseMin(u), high = high.cwiseMax(u);
      EXPECT_NEAR((high - low).maxCoeff(), 1, 0.1);  // as large as the page, about
    }
}

TEST(HeldSolve, OfAFlatSheetInPlaceIsTheSheet) {
  const TriMesh mesh = shapes::grid(8, 5, 2, 1);
  const OwnedDisk d = disk_of(mesh);
  VertexConstraints boundary, corners;
  UvMap sheet;
  for (const Vec3& p : d.chart->mesh.positions)
    sheet.push_back({0.1 + 0.3 * p.x(), 0.2 + 0.3 * p.y()});
  for (Index h : d.disk.loops.front()) {
    const Index v = d.disk.faces[std::size_t(h / 3)][std::size_t(h % 3)];
    boundary.hard.push_back({v, sheet[std::size_t(v)]});
    if (boundary.hard.size() % 9 == 1) corners.soft.push_back({v, sheet[std::size_t(v)], 2});
  }
  for (const UnwrapOptions& options : all_methods())
    for (const VertexConstraints& page : {boundary, corners}) {
      const PageSolve s = solved_on_page(d.disk, options, page);
      EXPECT_LT(greatest_gap(s.page, sheet), 1e-5);
      EXPECT_LT(s.solution.energy.back(), 1e-9);
    }
}

TEST(HeldSolve, MovedTargetsGiveWhatAFreshSolverGives) {
  const OwnedDisk d = disk_of(shapes::random_disk(10, 4));
  const auto points = scattered(d.disk, 8, 2);
  SerialExecutor serial;
  VertexConstraints page{{points.begin(), points.begin() + 4},
                         as_soft_constraints({points.begin() + 4, points.end()}, 0.5)};
  VertexConstraints moved = page;
  for (HardConstraint& p : moved.hard) p.at = Vec2(0.9 - p.at.y(), 2 * p.at.x());
  for (SoftConstraint& s : moved.soft) s.at = Vec2(0.9 - s.at.y(), 2 * s.at.x());
  for (const UnwrapOptions& options : all_methods()) {
    const ChartConstraints before = constrain_chart(d.disk, options, page, {}, serial);
    const ChartConstraints after = constrain_chart(d.disk, options, moved, {}, serial);
    Solver solver(d.disk, options, before.constrained, serial);
    const Solution first = solver.run(options.lambda, {});
    int factored = 0;
    SolveWatch watch;
    watch.on_stage = [&](Stage stage) { factored += stage == Stage::factor; };
    solver.move(after.constrained);
    const Solution second = solver.run(options.lambda, watch);
    EXPECT_EQ(factored, 0);
    const Solution fresh =
        Solver(d.disk, options, after.constrained, serial).run(options.lambda, {});
    EXPECT_EQ(greatest_gap(second.uv, fresh.uv), 0);
    EXPECT_EQ(second.energy, fresh.energy);
    solver.move(before.constrained);
    EXPECT_EQ(greatest_gap(solver.run(options.lambda, {}).uv, first.uv), 0);
  }
}

TEST(HeldSolve, DoesNotDependOnWhereThePageIsOrHowLarge) {
  const OwnedDisk d = disk_of(shapes::random_disk(10, 4));
  const VertexConstraints page{scattered(d.disk, 6, 2), {}};
  VertexConstraints far = page;
  for (HardConstraint& p : far.hard) p.at = 1e4 * Vec2(-p.at.y(), p.at.x()) + Vec2(3e6, -5e5);
  for (const UnwrapOptions& options : all_methods({.iterations = 10})) {
    const UvMap near = solved_on_page(d.disk, options, page).page;
    UvMap there = solved_on_page(d.disk, options, far).page;
    for (std::size_t v = 0; v < near.size(); ++v)
      EXPECT_LT((there[v] - (1e4 * Vec2(-near[v].y(), near[v].x()) + Vec2(3e6, -5e5))).norm(),
                1e-2);
  }
}

TEST(HeldSolve, AcceptsMirroredTargets) {
  const OwnedDisk d = disk_of(shapes::random_disk(10, 4));
  VertexConstraints page{scattered(d.disk, 5, 2), {}};
  for (HardConstraint& p : page.hard) p.at.x() = 1 - p.at.x();
  for (const UnwrapOptions& options : all_methods()) {
    const PageSolve s = solved_on_page(d.disk, options, page);
    for (const Vec2& u : s.page) EXPECT_TRUE(u.allFinite());
    for (const HardConstraint& p : page.hard) EXPECT_EQ(s.page[std::size_t(p.vertex)], p.at);
    EXPECT_GT(s.hold.frame->scale, 0.1);
  }
}

TEST(HeldSolve, AcceptsEveryWeightAndShape) {
  std::vector<TriMesh> meshes{shapes::random_disk(8, 4), shapes::annulus(16, 3), shapes::grid(1, 1),
                              shapes::grid(300, 1, 1e6, 1)};
  for (const TriMesh& mesh : meshes)
    for (double weight : {1e-9, 1e-3, 1e9}) {
      const OwnedDisk d = disk_of(mesh);
      const auto points = scattered(d.disk, 4, 2);
      const VertexConstraints soft{{}, as_soft_constraints(points, weight)};
      const VertexConstraints mixed{
          {points[0]}, as_soft_constraints({points.begin() + 1, points.end()}, weight)};
      for (const UnwrapOptions& options : all_methods())
        for (const VertexConstraints& page : {soft, mixed}) {
          const PageSolve s = solved_on_page(d.disk, options, page);
          for (const Vec2& u : s.page) ASSERT_TRUE(u.allFinite());
          EXPECT_GT(measure::uv_area(d.disk.rest, d.disk.faces, s.page), 0);
        }
    }
}

TEST(HeldSolve, DoesNotHoldByOtherMethodsAndNotWhenNothingIsAsked) {
  const OwnedDisk d = disk_of(shapes::grid(3, 3));
  SerialExecutor serial;
  EXPECT_TRUE(constrain_chart(d.disk, {}, {}, {}, serial).constrained.constraints.empty());
  const UnwrapOptions slim{.method = Method::slim, .boundary = BoundaryShape::circle};
  EXPECT_TRUE(constrain_chart(d.disk, slim, {}, {}, serial).constrained.constraints.empty());
}

TEST(HeldSolve, StopsWhenAskedWhileItLooksForTheScale) {
  const OwnedDisk d = disk_of(shapes::random_disk(10, 4));
  SerialExecutor serial;
  std::stop_source source;
  source.request_stop();
  try {
    constrain_chart(d.disk, {}, {scattered(d.disk, 3, 1), {}}, source.get_token(), serial);
    FAIL() << "not stopped";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace unwrapd::solve
