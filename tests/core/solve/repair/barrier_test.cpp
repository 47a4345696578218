#include "core/solve/repair/barrier.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>

#include "core/solve/methods/symmetric_dirichlet.hpp"
#include "core/solve/repair/newton.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::from_above;
using shapes::shaken;

constexpr double kRigid = std::numeric_limits<double>::infinity();

BarrierMesh loose_mesh(const Disk& disk, std::vector<char> hard = {}) {
  hard.resize(disk.positions.size(), 0);
  return {{disk.faces.begin(), disk.faces.end()},
          {disk.rest.begin(), disk.rest.end()},
          linear::number_free(hard)};
}

/// The energy of the header's formula, by the singular values of a matrix.
double energy_by_svd(const Disk& disk, const UvMap& uv, double weight) {
  double energy = 0;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    Eigen::Matrix2d x, u;
    const Triangle& f = disk.faces[t];
    for (int k : {0, 1}) {
      x.col(k) = disk.rest[t].edge[std::size_t(k)];
      u.col(k) = uv[std::size_t(f[std::size_t(k)])] - uv[std::size_t(f[std::size_t(k) + 1])];
    }
    const Eigen::Matrix2d j = u * x.inverse();
    const Eigen::Vector2d s = Eigen::JacobiSVD<Eigen::Matrix2d>(j).singularValues();
    const double d = j.determinant();
    const double fit = (s - Eigen::Vector2d::Ones()).squaredNorm();
    energy +=
        disk.rest[t].area * (fit + weight * ((j.squaredNorm() / 2 + (1 + d * d) / 2) / d - 2));
  }
  return energy;
}

Quadratic barrier_model(const BarrierMesh& mesh, const UvMap& uv, const Barrier& barrier) {
  Quadratic model = barrier_pattern(mesh);
  fill_barrier_model(mesh, uv, barrier, model);
  return model;
}

TEST(Barrier, IsTheArapEnergyPlusTheWall) {
  const auto owned = disk_of(shapes::random_disk(6, 1));
  const UvMap uv = shaken(from_above(owned.disk), 0.01, 2);
  const BarrierMesh mesh = loose_mesh(owned.disk);
  ASSERT_GT(least_determinant(mesh, uv), 0);
  for (double weight : {0.0, 0.1, 1.0})
    EXPECT_NEAR(barrier_energy(mesh, uv, {{kRigid}, weight, 0}),
                energy_by_svd(owned.disk, uv, weight), 1e-9);
}

TEST(Barrier, IsZeroForRotationsAndInfiniteForFlips) {
  const auto owned = disk_of(shapes::grid(3, 3));
  const BarrierMesh mesh = loose_mesh(owned.disk);
  UvMap uv = from_above(owned.disk);
  for (Vec2& u : uv) u = Vec2(-u.y(), u.x());
  EXPECT_NEAR(barrier_energy(mesh, uv, {{}, 1, 0}), 0, 1e-12);
  for (Vec2& u : uv) u.x() = -u.x();
  EXPECT_TRUE(std::isinf(barrier_energy(mesh, uv, {{}, 1, 0})));
  EXPECT_TRUE(std::isfinite(barrier_energy(mesh, uv, {{}, 1, 0.1})));
}

TEST(Barrier, GradientIsTheSlopeOfTheEnergy) {
  const auto owned = disk_of(shapes::random_disk(3, 5));
  std::vector<char> hard(owned.disk.positions.size(), 0);
  hard[3] = hard[7] = 1;
  const BarrierMesh mesh = loose_mesh(owned.disk, hard);
  for (const Barrier& barrier : {Barrier{{kRigid}, 1, 0.3},
                                 {{0.0}, 0.5, 0.3},
                                 {{0.2}, 0.1, 0.1},
                                 {{kRigid}, 0.1, 0},
                                 {{0.2}, 0, 0, 0.1}}) {
    UvMap uv = shaken(from_above(owned.disk), barrier.epsilon > 0 ? 0.4 : 0.02, 3);
    const Quadratic model = barrier_model(mesh, uv, barrier);
    for (std::size_t v = 0; v < uv.size(); ++v)
      for (int k : {0, 1}) {
        if (mesh.free.slot[v] == linear::kFixed) continue;
        constexpr double kStep = 1e-7;
        const double at = uv[v][k];
        uv[v][k] = at + kStep;
        const double above = barrier_energy(mesh, uv, barrier);
        uv[v][k] = at - kStep;
        const double below = barrier_energy(mesh, uv, barrier);
        uv[v][k] = at;
        const double slope = (above - below) / (2 * kStep);
        EXPECT_NEAR(model.gradient[2 * mesh.free.slot[v] + k], slope, 1e-5 * (1 + std::abs(slope)));
      }
  }
}

TEST(Barrier, HessianIsTheSlopeOfTheGradientWhereTheEnergyIsConvex) {
  const auto owned = disk_of(shapes::grid(2, 2));
  const BarrierMesh mesh = loose_mesh(owned.disk);
  UvMap uv = from_above(owned.disk);
  for (Vec2& u : uv) u *= 1.1;  // stretched a little: nothing there to project
  for (const Barrier& barrier : {Barrier{{kRigid}, 0.5, 0}, {{kRigid}, 0, 0, 0.5}}) {
    const Eigen::MatrixXd lower = barrier_model(mesh, uv, barrier).hessian;
    const Eigen::MatrixXd hessian = lower.selfadjointView<Eigen::Lower>();
    for (Index column = 0; column < hessian.cols(); ++column) {
      constexpr double kStep = 1e-6;
      const auto v = std::size_t(column / 2);
      UvMap above = uv, below = uv;
      above[v][column % 2] += kStep, below[v][column % 2] -= kStep;
      const Eigen::VectorXd slope = (barrier_model(mesh, above, barrier).gradient -
                                     barrier_model(mesh, below, barrier).gradient) /
                                    (2 * kStep);
      EXPECT_LT((slope - hessian.col(column)).cwiseAbs().maxCoeff(), 1e-5);
    }
  }
}

TEST(Barrier, CanBeTheSymmetricDirichletEnergy) {
  const auto owned = disk_of(shapes::random_disk(6, 1));
  UvMap uv = shaken(from_above(owned.disk), 0.01, 2);
  const BarrierMesh mesh = loose_mesh(owned.disk);
  SerialExecutor serial;
  double area = 0;
  for (const measure::RestTriangle& rest : owned.disk.rest) area += rest.area;
  const double whole = methods::symmetric_dirichlet_energy(owned.disk, uv, serial);
  EXPECT_NEAR(
      barrier_energy(mesh, uv, {{kRigid}, 0, 0, 0.3}) - barrier_energy(mesh, uv, {{kRigid}, 0, 0}),
      0.3 * (whole - 4 * area), 1e-9 * whole);
  for (Vec2& u : uv) u.x() = -u.x();
  EXPECT_TRUE(std::isinf(barrier_energy(mesh, uv, {{kRigid}, 0, 0, 0.3})));
}

TEST(Barrier, HessianIsNeverIndefinite) {
  const auto owned = disk_of(shapes::random_disk(3, 8));
  const BarrierMesh mesh = loose_mesh(owned.disk);
  for (unsigned seed = 0; seed < 20; ++seed) {
    const UvMap uv = shaken(from_above(owned.disk), 0.5, seed);
    for (double lambda : {0.0, 0.3, kRigid}) {
      const Eigen::MatrixXd lower = barrier_model(mesh, uv, {{lambda}, 1, 0.01}).hessian;
      const Eigen::MatrixXd hessian = lower.selfadjointView<Eigen::Lower>();
      const Eigen::VectorXd eigen =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(hessian).eigenvalues();
      EXPECT_GT(eigen.minCoeff(), -1e-9 * eigen.maxCoeff());
    }
  }
}

TEST(Barrier, ARefilledModelIsThatOfTheNewMapAlone) {
  const auto owned = disk_of(shapes::random_disk(3, 5));
  std::vector<char> hard(owned.disk.positions.size(), 0);
  hard[3] = hard[7] = 1;
  const BarrierMesh mesh = loose_mesh(owned.disk, hard);
  const UvMap first = shaken(from_above(owned.disk), 0.4, 1);
  const UvMap second = shaken(from_above(owned.disk), 0.4, 2);
  const Barrier barrier{{0.2}, 0.1, 0.1};
  Quadratic model = barrier_model(mesh, first, barrier);
  fill_barrier_model(mesh, second, barrier, model);
  const Quadratic fresh = barrier_model(mesh, second, barrier);
  EXPECT_EQ(model.gradient, fresh.gradient);
  EXPECT_EQ(Eigen::MatrixXd(model.hessian), Eigen::MatrixXd(fresh.hessian));
}

TEST(Newton, FallsToTheBottomWithoutAFlipOnTheWay) {
  const auto owned = disk_of(shapes::grid(6, 6));
  const BarrierMesh mesh = loose_mesh(owned.disk);
  UvMap uv = shaken(from_above(owned.disk), 0.03, 4);
  ASSERT_GT(least_determinant(mesh, uv), 0);
  Newton newton(mesh);
  double before = barrier_energy(mesh, uv, {{}, 1, 0});
  for (int k = 0; k < 40; ++k) {
    newton.step(uv, {{}, 1, 0});
    const double after = barrier_energy(mesh, uv, {{}, 1, 0});
    EXPECT_LE(after, before);  // infinite after a flip
    before = after;
  }
  EXPECT_LT(before, 1e-12);  // a flat mesh has an isometric map
}

TEST(Newton, LeavesFixedVerticesWhereTheyAre) {
  const auto owned = disk_of(shapes::random_disk(4, 9));
  std::vector<char> hard(owned.disk.positions.size(), 0);
  for (std::size_t v = 0; v < hard.size(); v += 3) hard[v] = 1;
  const BarrierMesh mesh = loose_mesh(owned.disk, hard);
  const UvMap start = from_above(owned.disk);
  UvMap uv = start;
  Newton newton(mesh);
  for (int k = 0; k < 10; ++k) newton.step(uv, {{}, 1, 0.1});
  double moved = 0;
  for (std::size_t v = 0; v < hard.size(); ++v) {
    EXPECT_TRUE(hard[v] == 0 || uv[v] == start[v]) << v;
    moved += (uv[v] - start[v]).norm();
  }
  EXPECT_GT(moved, 0.01);
}

}  // namespace
}  // namespace unwrapd::solve::repair
