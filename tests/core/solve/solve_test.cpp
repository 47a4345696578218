#include "core/solve/solve.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "tests/core/solve/cancel_at.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/similarity.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

Solution solved(const Disk& disk, const UnwrapOptions& options, const SolveWatch& watch = {}) {
  SerialExecutor serial;
  return Solver(disk, options, {}, serial).run(options.lambda, watch);
}

std::vector<TriMesh> curved_disks() {
  return {shapes::sphere_cap(24, 8, 1.5), shapes::random_disk(12, 3), shapes::cone(20, 6),
          shapes::annulus(20, 4), shapes::cylinder(16, 6)};
}

TEST(Solve, EnergyNeverRises) {
  for (const TriMesh& mesh : curved_disks())
    for (double lambda : {0.05, 0.5, 5.0}) {
      const OwnedDisk d = disk_of(mesh);
      for (const UnwrapOptions& options :
           {UnwrapOptions{.stop = {.iterations = 60}},
            UnwrapOptions{
                .method = Method::hybrid, .lambda = lambda, .stop = {.iterations = 60}}}) {
        const std::vector<double> energy = solved(d.disk, options).energy;
        for (std::size_t k = 1; k < energy.size(); ++k)
          EXPECT_LE(energy[k], energy[k - 1] * (1 + 1e-12) + 1e-24);
      }
    }
}

TEST(Solve, ReportedEnergyIsThatOfTheSingularValues) {  // Eq. (A2)
  for (const TriMesh& mesh : curved_disks()) {
    const OwnedDisk d = disk_of(mesh);
    const Solution s = solved(d.disk, {});
    EXPECT_NEAR(s.energy.back(), measure::arap_energy(d.disk.rest, d.disk.faces, s.uv), 1e-12);
    EXPECT_EQ(s.energy.size(), std::size_t(s.iterations) + 1);
    const Solution plain = solved(d.disk, {.stop = {.iterations = 10}});
    EXPECT_NEAR(plain.energy.back(), measure::arap_energy(d.disk.rest, d.disk.faces, plain.uv),
                1e-12);
    EXPECT_EQ(plain.iterations, 10);
    EXPECT_EQ(plain.energy.size(), 11U);
    EXPECT_EQ(plain.stop_reason, StopReason::iterations);
  }
}

/// One ARAP iteration with dense matrices and an SVD a triangle, on Eqs. (1) and (4) as printed.
UvMap dense_arap_iteration(const Disk& disk, const UvMap& uv) {
  const Index n = disk.vertex_count();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixX2d b = Eigen::MatrixX2d::Zero(n, 2);
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    const measure::RestTriangle& rest = disk.rest[t];
    const measure::UvEdges u = measure::uv_edges(disk.faces[t], uv);
    Eigen::Matrix2d s = Eigen::Matrix2d::Zero();  // the cross-covariance of Sec. 4.4.1
    for (std::size_t i = 0; i < 3; ++i) s += rest.cot[i] * u[i] * rest.edge[i].transpose();
    const Eigen::JacobiSVD<Eigen::Matrix2d, Eigen::FullPivHouseholderQRPreconditioner> svd(
        s, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix2d left = svd.matrixU();
    if ((left * svd.matrixV().transpose()).determinant() < 0) left.col(1) *= -1;
    const Eigen::Matrix2d rotation = left * svd.matrixV().transpose();
    for (std::size_t i = 0; i < 3; ++i) {
      const Index p = disk.faces[t][i], q = disk.faces[t][(i + 1) % 3];
      a(p, p) += rest.cot[i], a(q, q) += rest.cot[i];
      a(p, q) -= rest.cot[i], a(q, p) -= rest.cot[i];
      const Eigen::RowVector2d g = (rest.cot[i] * rotation * rest.edge[i]).transpose();
      b.row(p) += g, b.row(q) -= g;
    }
  }
  const Eigen::MatrixX2d x = a.completeOrthogonalDecomposition().solve(b);
  UvMap next;
  for (Index v = 0; v < n; ++v) next.emplace_back(x.row(v));
  return next;
}

TEST(Solve, AgreesWithDenseMatricesAndAnSvd) {
  for (const TriMesh& mesh : {shapes::random_disk(8, 5), shapes::annulus(12, 3)}) {
    const OwnedDisk d = disk_of(mesh);
    UvMap dense = initial_map(d.disk, InitialMap::tutte, arap::GlobalStep(d.disk, {}));
    for (int k = 0; k < 5; ++k) dense = dense_arap_iteration(d.disk, dense);
    const UvMap uv = solved(d.disk, {.stop = {.iterations = 5}, .initial = InitialMap::tutte}).uv;
    EXPECT_LT(gap_up_to_similarity(uv, dense), 1e-8);
  }
}

TEST(Solve, FlattensDevelopableShapesWithoutEnergy) {
  for (const TriMesh& mesh : {shapes::half_cylinder(30, 12), shapes::cone_sector(24, 10),
                              shapes::grid(15, 5), shapes::annulus(24, 5)}) {
    const OwnedDisk d = disk_of(mesh);
    const Solution s = solved(d.disk, {});
    EXPECT_LT(s.energy.back(), 1e-10);
    EXPECT_EQ(measure::distortion_sums(d.disk.rest, d.disk.faces, s.uv).flipped, 0);
  }
}

TEST(Solve, HybridIsAsapAtLambdaZeroAndBelowTheCollapse) {
  for (const TriMesh& mesh : curved_disks()) {
    const OwnedDisk d = disk_of(mesh);
    const UvMap asap = solved(d.disk, {.method = Method::asap}).uv;
    const double c = measure::asap_energy(d.disk.rest, d.disk.faces, asap);
    for (double lambda : {0.0, 1e-15, 0.49 * c})
      EXPECT_LT(gap_up_to_similarity(
                    solved(d.disk, {.method = Method::hybrid, .lambda = lambda}).uv, asap),
                1e-6);
  }
}

TEST(Solve, HybridIsArapAtLambdaInfinity) {
  for (const TriMesh& mesh : curved_disks()) {
    const OwnedDisk d = disk_of(mesh);
    const UvMap arap = solved(d.disk, {}).uv;
    for (double lambda : {1e9, 1e12, std::numeric_limits<double>::infinity()})
      EXPECT_LT(gap_up_to_similarity(
                    solved(d.disk, {.method = Method::hybrid, .lambda = lambda}).uv, arap),
                1e-6);
  }
}

TEST(Solve, SmallLambdaNeverCollapses) {
  for (const TriMesh& mesh : curved_disks())
    for (double lambda : {1e-6, 1e-4, 1e-3, 1e-2, 3e-2, 0.1}) {
      const OwnedDisk d = disk_of(mesh);
      const Solution s =
          solved(d.disk, {.method = Method::hybrid, .lambda = lambda, .stop = {.iterations = 500}});
      EXPECT_GE(measure::uv_area(d.disk.rest, d.disk.faces, s.uv), arap::kMinAreaShare);
    }
}

TEST(Solve, PaperLambdaIsThatOfEquation5) {  // the energy as printed, in mesh units
  TriMesh mesh = shapes::random_disk(10, 7);
  for (Vec3& p : mesh.positions) p *= 3;
  const OwnedDisk d = disk_of(mesh);
  const UnwrapOptions options{
      .method = Method::hybrid, .lambda = 0.7, .lambda_units = LambdaUnits::paper};
  const Solution s = solved(d.disk, options);
  const double area = measure::surface_area(mesh);
  double printed = 0;
  for (std::size_t t = 0; t < d.disk.faces.size(); ++t) {
    const double a = d.disk.rest[t].area * area;
    const measure::Jacobian j =
        measure::jacobian(d.disk.rest[t], measure::uv_edges(d.disk.faces[t], s.uv));
    const arap::Similarity l = arap::fit_similarity(j, options.lambda / (2 * a));
    const double excess = l.a * l.a + l.b * l.b - 1;
    printed += arap::fit_energy(j, l, a, 0) + 0.5 * options.lambda * excess * excess;
  }
  EXPECT_NEAR(s.energy.back() * area / printed, 1, 1e-9);
}

TEST(Solve, DoesNotDependOnScalePlaceOrNumbering) {
  const TriMesh mesh = shapes::random_disk(14, 9);
  const auto moved_by = [&](double scale, const Vec3& by) {
    TriMesh other = mesh;
    for (Vec3& p : other.positions) p = p * scale + by;
    return other;
  };
  for (Method method : {Method::asap, Method::arap, Method::hybrid}) {
    const UnwrapOptions options{.method = method, .lambda = 0.2};
    const OwnedDisk reference = disk_of(mesh);
    const Solution expected = solved(reference.disk, options);
    for (const TriMesh& other :
         {moved_by(1e-6, {0, 0, 0}), moved_by(1e6, {0, 0, 0}), moved_by(1, {1e5, -1e5, 1e5})}) {
      const OwnedDisk d = disk_of(other);
      const Solution s = solved(d.disk, options);
      EXPECT_LT(gap_up_to_similarity(s.uv, expected.uv), 1e-6);
    }
  }
}

TEST(Solve, DoesNotDependOnTheOrderOfVerticesAndFaces) {
  const TriMesh mesh = shapes::random_disk(14, 9), other = shapes::shuffled(mesh, 10);
  std::vector<std::size_t> where;  // of each vertex of mesh, in other
  for (const Vec3& p : mesh.positions)
    where.push_back(std::size_t(std::find(other.positions.begin(), other.positions.end(), p) -
                                other.positions.begin()));
  for (Method method : {Method::asap, Method::arap, Method::hybrid}) {
    const UnwrapOptions options{.method = method, .lambda = 0.2, .seams = SeamMode::keep};
    SerialExecutor serial;
    const auto uv_of = [&](const TriMesh& m) {
      const std::vector<Surface> surface{shapes::surface_of(m)};
      const charts::Charts charts = charts::make_charts(surface[0], SeamMode::keep);
      const Disk disk = make_disk(charts.charts[0].mesh, charts.charts[0].loops);
      const UvMap chart_uv = solved(disk, options).uv;
      UvMap uv(m.positions.size());
      for (std::size_t t = 0; t < disk.faces.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) {
          const auto source = std::size_t(charts.charts[0].face_source[t]);
          uv[std::size_t(m.faces[source][i])] = chart_uv[std::size_t(disk.faces[t][i])];
        }
      return uv;
    };
    const UvMap a = uv_of(mesh), b = uv_of(other);
    UvMap b_in_order;
    for (std::size_t v : where) b_in_order.push_back(b[v]);
    EXPECT_LT(gap_up_to_similarity(a, b_in_order), 1e-6);
  }
}

TEST(Solve, GivesTheSameBytesOnOneAndTwoThreads) {
  const OwnedDisk d = disk_of(shapes::random_disk(90, 11));  // 16,200 faces: several blocks
  SerialExecutor one;
  TwoThreads two;
  const UnwrapOptions options{.method = Method::hybrid, .lambda = 0.3};
  const Solution a = Solver(d.disk, options, {}, one).run(options.lambda, {});
  const Solution b = Solver(d.disk, options, {}, two).run(options.lambda, {});
  EXPECT_EQ(a.uv, b.uv);
  EXPECT_EQ(a.energy, b.energy);
}

TEST(Solve, StopsWithinOneIterationOfACancel) {
  const OwnedDisk d = disk_of(shapes::random_disk(10, 12));
  expect_cancelled_at(
      3, [&](const SolveWatch& watch) { solved(d.disk, {.stop = {.iterations = 1000}}, watch); });
}

TEST(Solve, SurvivesNeedlesCapsAndHighValence) {
  TriMesh fan{{{0, 0, 0}}, {}};
  for (Index k = 0; k < 2000; ++k) {
    const double phi = shapes::kTurn * k / 2000;
    fan.positions.emplace_back(std::cos(phi), std::sin(phi), 1);
    fan.faces.push_back({0, 1 + k, 1 + (k + 1) % 2000});
  }
  TriMesh caps = shapes::grid(10, 10);
  for (std::size_t v = 0; v < caps.positions.size(); ++v)
    caps.positions[v].y() = 1e-9 * std::floor(double(v) / 11);
  for (const TriMesh& mesh : {fan, caps, shapes::grid(200, 1, 1, 5000)})
    for (Method method : {Method::asap, Method::arap}) {
      const OwnedDisk d = disk_of(mesh);
      for (const Vec2& u : solved(d.disk, {.method = method}).uv) EXPECT_TRUE(u.allFinite());
    }
}

TEST(Solve, FlattensARibbonAMillionTimesLongerThanWide) {
  const OwnedDisk d = disk_of(shapes::grid(3000, 1, 1500, 1e-4));
  EXPECT_LT(solved(d.disk, {}).energy.back(), 1e-4);
  for (Method method : {Method::asap, Method::arap, Method::hybrid})
    for (InitialMap start : {InitialMap::lscm, InitialMap::mean_value, InitialMap::tutte})
      for (Pins pins : {Pins::diameter, Pins::spectral})
        for (const Vec2& u : solved(d.disk, {.method = method, .initial = start, .pins = pins}).uv)
          ASSERT_TRUE(u.allFinite());
}

}  // namespace
}  // namespace unwrapd::solve
