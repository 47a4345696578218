// What holds do to the linear systems: against dense matrices and finite differences.
#include "core/solve/base/vertex_constraints.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/measure/energy.hpp"
#include "core/solve/arap/global_step.hpp"
#include "core/solve/arap/objective.hpp"
#include "core/solve/maps/conformal_system.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/holds_of.hpp"
#include "tests/core/solve/ranks.hpp"

namespace unwrapd::solve {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

/// count different vertices, at random places of the unit square.
std::vector<HardConstraint> random_points(const Disk& disk, std::size_t count, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  std::vector<Index> vertex(disk.positions.size());
  std::iota(vertex.begin(), vertex.end(), 0);
  std::shuffle(vertex.begin(), vertex.end(), rng);
  std::vector<HardConstraint> points;
  for (std::size_t k = 0; k < count; ++k)
    points.push_back({vertex[k], Vec2(place(rng), place(rng))});
  return points;
}

/// The first half of the points fixed, the others on soft constraints.
VertexConstraints random_holds(const Disk& disk, std::size_t count, unsigned seed,
                               double weight = 0.7) {
  const auto points = random_points(disk, count, seed);
  const auto middle = points.begin() + long(count / 2);
  return {{points.begin(), middle}, as_soft_constraints({middle, points.end()}, weight)};
}

/// The conformal energy and the soft constraints as the rows of a dense least-squares problem over
/// the free coordinates: each triangle's deformation (f, g) of its Jacobian, twice its area the
/// weight.
UvMap dense_asap(const Disk& disk, const VertexConstraints& constraints) {
  const auto n = Eigen::Index(disk.vertex_count());
  const auto faces = Eigen::Index(disk.faces.size());
  Eigen::MatrixXd a =
      Eigen::MatrixXd::Zero(2 * faces + 2 * Eigen::Index(constraints.soft.size()), 2 * n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(a.rows());
  UvMap unit(std::size_t(n), Vec2::Zero());
  for (Eigen::Index t = 0; t < faces; ++t)
    for (Index v : disk.faces[std::size_t(t)])
      for (int c = 0; c < 2; ++c) {
        unit[std::size_t(v)][c] = 1;
        const measure::Jacobian j = measure::jacobian(
            disk.rest[std::size_t(t)], measure::uv_edges(disk.faces[std::size_t(t)], unit));
        const double w = std::sqrt(2 * disk.rest[std::size_t(t)].area);
        a(2 * t, 2 * v + c) = w * j.f, a(2 * t + 1, 2 * v + c) = w * j.g;
        unit[std::size_t(v)][c] = 0;
      }
  for (std::size_t k = 0; k < constraints.soft.size(); ++k)
    for (int c = 0; c < 2; ++c) {
      const Eigen::Index row = 2 * faces + 2 * Eigen::Index(k) + c;
      const double w = std::sqrt(constraints.soft[k].weight);
      a(row, 2 * constraints.soft[k].vertex + c) = w;
      b[row] = w * constraints.soft[k].at[c];
    }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * n);
  for (const HardConstraint& p : constraints.hard) x.segment<2>(2 * p.vertex) = p.at;
  b -= a * x;
  for (const HardConstraint& p : constraints.hard) a.middleCols<2>(2 * p.vertex).setZero();
  x += a.completeOrthogonalDecomposition().solve(b);
  UvMap uv;
  for (Eigen::Index v = 0; v < n; ++v) uv.emplace_back(x.segment<2>(2 * v));
  return uv;
}

std::vector<TriMesh> small_disks() {
  return {shapes::random_disk(7, 5), shapes::annulus(12, 3), shapes::cone(9, 3)};
}

TEST(ConformalSystem, AgreesWithDenseLeastSquares) {
  for (const TriMesh& mesh : small_disks()) {
    const OwnedDisk d = disk_of(mesh);
    for (std::size_t count : {2U, 3U, 20U}) {
      const VertexConstraints pins{random_points(d.disk, count, 1), {}};
      const VertexConstraints soft{{}, as_soft_constraints(random_points(d.disk, count, 2), 0.3)};
      for (const VertexConstraints& constraints : {pins, soft, random_holds(d.disk, count, 3)})
        EXPECT_LT(greatest_gap(maps::ConformalSystem(d.disk, constraints).solve(constraints),
                               dense_asap(d.disk, constraints)),
                  1e-8)
            << count;
    }
  }
}

TEST(ConformalSystem, HoldsFixedVerticesToTheLastBit) {
  const OwnedDisk d = disk_of(shapes::random_disk(9, 4));
  const VertexConstraints constraints = random_holds(d.disk, 12, 7);
  const UvMap uv = maps::ConformalSystem(d.disk, constraints).solve(constraints);
  for (const HardConstraint& p : constraints.hard) EXPECT_EQ(uv[std::size_t(p.vertex)], p.at);
}

TEST(ConformalSystem, SolvesForOtherTargetsAsIfMadeForThem) {
  const OwnedDisk d = disk_of(shapes::random_disk(9, 4));
  VertexConstraints constraints = random_holds(d.disk, 12, 7);
  const maps::ConformalSystem system(d.disk, constraints);
  for (HardConstraint& p : constraints.hard) p.at = 3 * p.at + Vec2(1, -2);
  for (SoftConstraint& s : constraints.soft) s.at = Vec2(-s.at.y(), s.at.x());
  EXPECT_EQ(greatest_gap(system.solve(constraints),
                         maps::ConformalSystem(d.disk, constraints).solve(constraints)),
            0);
}

TEST(ConformalSystem, HasNothingToSolveWhenAllIsFixed) {
  const OwnedDisk d = disk_of(shapes::grid(2, 2));
  const VertexConstraints constraints{random_points(d.disk, d.disk.positions.size(), 1), {}};
  const UvMap uv = maps::ConformalSystem(d.disk, constraints).solve(constraints);
  for (const HardConstraint& p : constraints.hard) EXPECT_EQ(uv[std::size_t(p.vertex)], p.at);
}

/// dE/du by central differences, zero at fixed vertices.
std::vector<Vec2> numeric_gradient(arap::Objective& objective, const UvMap& uv,
                                   const VertexConstraints& constraints) {
  std::vector<Vec2> unused(uv.size()), gradient(uv.size());
  UvMap moved = uv;
  const double h = 1e-5;
  for (std::size_t v = 0; v < uv.size(); ++v)
    for (int c = 0; c < 2; ++c) {
      moved[v][c] = uv[v][c] + h;
      const double up = objective.evaluate(moved, unused);
      moved[v][c] = uv[v][c] - h;
      gradient[v][c] = (up - objective.evaluate(moved, unused)) / (2 * h);
      moved[v][c] = uv[v][c];
    }
  for (const HardConstraint& p : constraints.hard) gradient[std::size_t(p.vertex)].setZero();
  return gradient;
}

TEST(Objective, ForceIsMinusTheGradientWithSpringsAndFixedVertices) {
  SerialExecutor serial;
  for (const TriMesh& mesh : small_disks()) {
    const OwnedDisk d = disk_of(mesh);
    const VertexConstraints constraints = random_holds(d.disk, 10, 6);
    const UvMap uv = maps::tutte_map(d.disk);
    for (double lambda : {0.0, 0.7, std::numeric_limits<double>::infinity()}) {
      arap::Objective objective(d.disk, {lambda, false}, constraints, shapes::as_listed(uv.size()),
                                serial);
      std::vector<Vec2> force(uv.size());
      objective.evaluate(uv, force);
      const std::vector<Vec2> gradient = numeric_gradient(objective, uv, constraints);
      for (std::size_t v = 0; v < uv.size(); ++v) EXPECT_LT((force[v] + gradient[v]).norm(), 1e-7);
    }
  }
}

TEST(Objective, CountsTheSpringsInItsEnergy) {
  SerialExecutor serial;
  const OwnedDisk d = disk_of(shapes::random_disk(7, 5));
  const VertexConstraints constraints = random_holds(d.disk, 10, 6);
  const UvMap uv = maps::tutte_map(d.disk);
  std::vector<Vec2> force(uv.size());
  double soft = 0;
  for (const SoftConstraint& s : constraints.soft)
    soft += s.weight * (uv[std::size_t(s.vertex)] - s.at).squaredNorm();
  EXPECT_NEAR(arap::Objective(d.disk, {}, constraints, shapes::as_listed(uv.size()), serial)
                  .evaluate(uv, force),
              measure::arap_energy(d.disk.rest, d.disk.faces, uv) + soft, 1e-12);
  EXPECT_NEAR(soft_constraint_energy(constraints, uv), soft, 1e-15);
}

/// The dense matrix of Eq. (4), soft constraints on its diagonal.
Eigen::MatrixXd dense_matrix(const Disk& disk, const VertexConstraints& constraints) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(disk.vertex_count(), disk.vertex_count());
  for (std::size_t t = 0; t < disk.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index p = disk.faces[t][i], q = disk.faces[t][(i + 1) % 3];
      const double w = disk.rest[t].cot[i];
      a(p, p) += w, a(q, q) += w, a(p, q) -= w, a(q, p) -= w;
    }
  for (const SoftConstraint& s : constraints.soft) a(s.vertex, s.vertex) += 2 * s.weight;
  return a;
}

TEST(GlobalStep, SolvesTheRowsOfTheFreeVerticesAndLeavesTheOthers) {
  for (const TriMesh& mesh : small_disks()) {
    const OwnedDisk d = disk_of(mesh);
    const VertexConstraints pins{random_points(d.disk, 6, 1), {}};
    const VertexConstraints soft{{}, as_soft_constraints(random_points(d.disk, 6, 2), 1e-6)};
    for (const VertexConstraints& constraints : {pins, soft, random_holds(d.disk, 9, 3)}) {
      const auto n = Eigen::Index(d.disk.vertex_count());
      const Eigen::MatrixX2d force = Eigen::MatrixX2d::Random(n, 2);
      std::vector<Vec2> change;
      for (Eigen::Index v = 0; v < n; ++v) change.emplace_back(force.row(v));
      arap::GlobalStep(d.disk, constraints).solve(change);
      Eigen::MatrixX2d x(n, 2);
      for (Eigen::Index v = 0; v < n; ++v) x.row(v) = change[std::size_t(v)];
      Eigen::MatrixX2d left = dense_matrix(d.disk, constraints) * x - force;
      for (const HardConstraint& p : constraints.hard) {
        EXPECT_EQ(change[std::size_t(p.vertex)], Vec2::Zero());
        left.row(p.vertex).setZero();
      }
      EXPECT_LT(left.norm(), 1e-6);
    }
  }
}

TEST(GlobalStep, DoesNothingWhenAllIsFixed) {
  const OwnedDisk d = disk_of(shapes::grid(2, 2));
  const arap::GlobalStep global(d.disk, {random_points(d.disk, d.disk.positions.size(), 1), {}});
  std::vector<Vec2> force(d.disk.positions.size(), Vec2(1, 2));
  global.solve(force);
  for (const Vec2& f : force) EXPECT_EQ(f, Vec2::Zero());
}

}  // namespace
}  // namespace unwrapd::solve
