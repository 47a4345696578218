// The symmetric Dirichlet energy by singular values, its derivatives by differences.
#include "core/solve/methods/symmetric_dirichlet.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/measure/orientation.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::methods {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

double energy_of(const Disk& disk, const UvMap& uv) {
  SerialExecutor serial;
  return symmetric_dirichlet_energy(disk, uv, serial);
}

Eigen::Matrix2d matrix(const measure::Jacobian& j) {
  return (Eigen::Matrix2d() << j.e + j.f, j.g - j.h, j.g + j.h, j.e - j.f).finished();
}

measure::Jacobian jacobian_of(const Disk& disk, std::size_t t, const UvMap& uv) {
  return measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv));
}

/// A map without flips that is far from isometric.
UvMap stretched(const Disk& disk) {
  UvMap uv = maps::tutte_map(disk);
  for (Vec2& u : uv) u = Vec2(1.5 * u.x() + 0.2 * u.y() * u.y(), 0.8 * u.y());
  return uv;
}

TEST(SymmetricDirichlet, IsTheSumOverSingularValues) {
  std::mt19937 rng(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 1000; ++k) {
    const measure::Jacobian j{normal(rng), normal(rng), normal(rng), normal(rng)};
    const Eigen::Vector2d s = Eigen::JacobiSVD<Eigen::Matrix2d>(matrix(j)).singularValues();
    const double expected = s.squaredNorm() + s.cwiseInverse().squaredNorm();
    if (matrix(j).determinant() > 0)
      EXPECT_NEAR(symmetric_dirichlet(j), expected, 1e-9 * expected);
    else
      EXPECT_TRUE(std::isinf(symmetric_dirichlet(j)));
  }
}

TEST(SymmetricDirichlet, HasTheSlopeOfItsDifferences) {
  const OwnedDisk d = disk_of(shapes::random_disk(6, 2));
  UvMap uv = stretched(d.disk);
  std::vector<Vec2> gradient(uv.size());
  SerialExecutor serial;
  symmetric_dirichlet_gradient(d.disk, uv, gradient, serial);
  for (std::size_t v = 0; v < uv.size(); ++v)
    for (int axis : {0, 1}) {
      constexpr double h = 1e-6;
      const double at = uv[v][axis];
      uv[v][axis] = at + h;
      const double above = energy_of(d.disk, uv);
      uv[v][axis] = at - h;
      const double below = energy_of(d.disk, uv);
      uv[v][axis] = at;
      EXPECT_NEAR(gradient[v][axis], (above - below) / (2 * h), 1e-5) << v;
    }
}

TEST(SymmetricDirichlet, IsInfiniteWhereATriangleIsNotUpright) {
  const OwnedDisk d = disk_of(shapes::grid(2, 2));
  UvMap uv = maps::tutte_map(d.disk);
  EXPECT_TRUE(std::isfinite(energy_of(d.disk, uv)));
  std::swap(uv[0], uv[8]);
  EXPECT_TRUE(std::isinf(energy_of(d.disk, uv)));
  for (Vec2& u : uv) u.y() = 0;
  EXPECT_TRUE(std::isinf(energy_of(d.disk, uv)));
}

TEST(SymmetricDirichlet, AsksTheExactTestWhereRoundingHidesAFlip) {
  const OwnedDisk d = disk_of(shapes::grid(1, 1));
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> unit(0.1, 1);
  int hidden = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec2 a(unit(rng), unit(rng)), along(unit(rng), unit(rng));
    UvMap uv{a, a + unit(rng) * along, a + along, a + unit(rng) * along};  // on a line, nearly
    for (std::size_t t : {0U, 1U})
      hidden += jacobian_of(d.disk, t, uv).determinant() > 0 &&
                measure::orientation(d.disk.faces[t], uv) <= 0;
    const bool is_flipped = !measure::flipped_faces(d.disk.faces, uv).empty();
    ASSERT_TRUE(!is_flipped || std::isinf(energy_of(d.disk, uv))) << k;
  }
  EXPECT_GT(hidden, 0);
}

// Rabinovich et al. 2017, Sec. 4: what the weights are for.
TEST(SlimProxy, HasTheSlopeOfTheEnergy) {
  const OwnedDisk d = disk_of(shapes::random_disk(6, 3));
  const UvMap uv = stretched(d.disk);
  for (std::size_t t = 0; t < d.disk.faces.size(); ++t) {
    const measure::RestTriangle& rest = d.disk.rest[t];
    const measure::Jacobian j = jacobian_of(d.disk, t, uv);
    const Eigen::JacobiSVD<Eigen::Matrix2d> svd(matrix(j),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix2d turn = svd.matrixU() * svd.matrixV().transpose();
    const linear::PairElement element = proxy_element(rest, j);
    const std::array<Vec2, 3> x{Vec2(0, 0), Vec2(-rest.edge[0]), Vec2(rest.edge[2])};
    Eigen::Matrix<double, 6, 1> away;  // of the image from the turned rest triangle
    for (std::size_t i = 0; i < 3; ++i)
      away.segment<2>(2 * Index(i)) = uv[std::size_t(d.disk.faces[t][i])] - turn * x[i];
    Eigen::Matrix<double, 6, 6> full;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t k = 0; k < 6; ++k)
        full(Index(i), Index(k)) = i >= k ? element[i][k] : element[k][i];
    const Eigen::Matrix<double, 6, 1> slope = full * away;

    const Eigen::Vector2d s = svd.singularValues();
    const Eigen::Vector2d bent = s.array() - s.array().pow(-3);
    const Eigen::Matrix2d outer =
        2 * rest.area * svd.matrixU() * bent.asDiagonal() * svd.matrixV().transpose();
    Eigen::Matrix2d sides;
    sides << x[1] - x[0], x[2] - x[0];
    const Eigen::Matrix2d pull = outer * sides.inverse().transpose();  // at corners 1 and 2
    EXPECT_LT((slope.segment<2>(2) - pull.col(0)).norm(), 1e-8 * (1 + pull.norm()));
    EXPECT_LT((slope.segment<2>(4) - pull.col(1)).norm(), 1e-8 * (1 + pull.norm()));
    EXPECT_LT((slope.segment<2>(0) + pull.col(0) + pull.col(1)).norm(), 1e-8 * (1 + pull.norm()));
  }
}

TEST(SlimProxy, IsIsotropicWhereTheMapIsConformal) {  // no direction to divide by
  const OwnedDisk d = disk_of(shapes::grid(1, 1));
  const linear::PairElement e = proxy_element(d.disk.rest[0], measure::Jacobian{2, 0, 0, 0});
  const double weight = 3 * 5 / 8.0;  // (s + 1) (s^2 + 1) / s^3 at s = 2
  const measure::RestTriangle& rest = d.disk.rest[0];
  EXPECT_NEAR(e[2][0], -weight * rest.cot[0], 1e-12);  // 2 A grad . grad = -cot
  EXPECT_NEAR(e[2][1], 0, 1e-12);
}

TEST(StepToFlip, IsWhereTheFirstTriangleHasNoArea) {
  std::mt19937 rng(4);
  std::normal_distribution<double> normal(0, 0.3);
  const OwnedDisk d = disk_of(shapes::random_disk(7, 5));
  const UvMap uv = stretched(d.disk);
  for (int k = 0; k < 50; ++k) {
    std::vector<Vec2> step(uv.size());
    for (Vec2& s : step) s = Vec2(normal(rng), normal(rng));
    SerialExecutor serial;
    const double length = step_to_flip(d.disk, uv, step, serial);
    const auto least_after = [&](double t) {
      UvMap next = uv;
      for (std::size_t v = 0; v < next.size(); ++v) next[v] += t * step[v];
      double least = 1e9;
      for (std::size_t f = 0; f < d.disk.faces.size(); ++f)
        least = std::min(least, jacobian_of(d.disk, f, next).determinant());
      return least;
    };
    for (double share : {0.1, 0.5, 0.9, 0.999}) EXPECT_GT(least_after(share * length), 0);
    EXPECT_NEAR(least_after(length), 0, 1e-9);
  }
}

TEST(StepToFlip, IsNeverForAShift) {
  const OwnedDisk d = disk_of(shapes::random_disk(4, 6));
  const std::vector<Vec2> shift(d.disk.positions.size(), Vec2(3, -1));
  SerialExecutor serial;
  EXPECT_TRUE(std::isinf(step_to_flip(d.disk, stretched(d.disk), shift, serial)));
}

}  // namespace
}  // namespace unwrapd::solve::methods
