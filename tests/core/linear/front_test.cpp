#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "core/linear/front.hpp"

namespace unwrapd {
namespace {

Eigen::MatrixXd random_definite(Eigen::Index n, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(rng); });
  return a * a.transpose() + Eigen::MatrixXd::Identity(n, n);
}

/// The row of the front that holds row i of the matrix.
std::size_t row_in(const Front& front, PanelShape shape, std::size_t i) {
  return i < shape.pivots ? i : i - shape.pivots + front.update_begin();
}

void fill(Front& front, PanelShape shape, const Eigen::MatrixXd& a) {
  front.reset(shape);
  for (std::size_t j = 0; j < shape.pivots + shape.below; ++j) {
    const std::size_t column = row_in(front, shape, j);
    for (std::size_t i = j; i < shape.pivots + shape.below; ++i)
      front.diagonal(column)[row_in(front, shape, i) - column] =
          a(Eigen::Index(i), Eigen::Index(j));
  }
}

Eigen::MatrixXd unpacked(const std::vector<double>& panel, PanelShape shape) {
  Eigen::MatrixXd dense =
      Eigen::MatrixXd::Zero(Eigen::Index(shape.height()), Eigen::Index(shape.pivots));
  for (std::size_t k = 0; k < shape.pivots; k += kPack)
    for (std::size_t c = 0; c < shape.width(k); ++c)
      for (std::size_t r = k; r < shape.height(); ++r)
        dense(Eigen::Index(r), Eigen::Index(k + c)) = panel[shape.entry(r, k, c)];
  return dense;
}

std::vector<PanelShape> shapes_of_fronts() {
  std::vector<PanelShape> all;
  for (std::size_t pivots : {1, 2, 3, 4, 5, 7, 8, 13, 63, 64, 65, 131})
    for (std::size_t below : {0, 1, 2, 3, 6, 9, 40, 70}) all.push_back({pivots, below});
  return all;
}

TEST(Front, LeavesTheSchurComplementAndTheInversePanel) {
  Front front;  // reused: nothing of the front before may show
  for (const PanelShape& shape : shapes_of_fronts()) {
    const auto p = Eigen::Index(shape.pivots), b = Eigen::Index(shape.below);
    const Eigen::MatrixXd a = random_definite(p + b, 1 + unsigned(p + b));
    fill(front, shape, a);
    std::vector<double> panel(shape.size(), std::numeric_limits<double>::quiet_NaN());
    ASSERT_TRUE(front.factor(panel.data()));

    const Eigen::MatrixXd l = a.topLeftCorner(p, p).llt().matrixL();
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(Eigen::Index(shape.height()), p);
    expected.topRows(p) = l.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(p, p));
    Eigen::MatrixXd schur(b, b);
    if (b > 0) {  // Eigen takes the address of what an empty matrix has not
      const Eigen::MatrixXd below =
          l.triangularView<Eigen::Lower>().solve(a.bottomLeftCorner(b, p).transpose()).transpose();
      expected.middleRows(p, b) = below * expected.topRows(p);
      schur = a.bottomRightCorner(b, b) - below * below.transpose();
    }
    EXPECT_LT((unpacked(panel, shape) - expected).norm(), 1e-10 * (1 + expected.norm()));

    for (Eigen::Index j = 0; j < b; ++j)
      for (Eigen::Index i = j; i < b; ++i)
        EXPECT_NEAR(front.diagonal(front.update_begin() + std::size_t(j))[i - j], schur(i, j),
                    1e-10 * a.norm());
  }
}

TEST(Front, GivesTheSameBitsWithAnyRegisters) {
  Front wide, narrow;
  for (const PanelShape& shape : shapes_of_fronts()) {
    const auto n = Eigen::Index(shape.pivots + shape.below);
    const Eigen::MatrixXd a = random_definite(n, 5);
    std::vector<double> panel(shape.size()), other(shape.size());
    fill(wide, shape, a), fill(narrow, shape, a);
    ASSERT_TRUE(wide.factor(panel.data()) && narrow.factor_on_baseline(other.data()));
    EXPECT_EQ(panel, other);
    const std::size_t end = wide.update_begin() + shape.below;
    for (std::size_t j = wide.update_begin(); j < end; ++j)
      EXPECT_TRUE(std::equal(wide.diagonal(j), wide.diagonal(j) + (end - j), narrow.diagonal(j)));
  }
}

TEST(Front, RefusesPivotsThatAreNotPositive) {
  Front front;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const PanelShape shape : {PanelShape{1, 3}, {5, 2}, {70, 4}})
    for (double bad : {0.0, -1.0, nan, infinity})
      for (std::size_t at : {std::size_t(0), shape.pivots - 1}) {
        Eigen::MatrixXd a = random_definite(Eigen::Index(shape.pivots + shape.below), 2);
        a(Eigen::Index(at), Eigen::Index(at)) = bad;
        fill(front, shape, a);
        std::vector<double> panel(shape.size());
        EXPECT_FALSE(front.factor(panel.data())) << shape.pivots << ' ' << bad << ' ' << at;
      }
}

TEST(Panel, StoresEveryEntryOnce) {
  for (const PanelShape& shape : shapes_of_fronts()) {
    std::vector<int> used(shape.size(), 0);
    for (std::size_t k = 0; k < shape.pivots; k += kPack)
      for (std::size_t c = 0; c < shape.width(k); ++c)
        for (std::size_t r = k; r < shape.height(); ++r) {
          ASSERT_LT(shape.entry(r, k, c), used.size());
          ++used[shape.entry(r, k, c)];
        }
    EXPECT_EQ(std::count(used.begin(), used.end(), 1), std::ptrdiff_t(used.size()));
  }
}

TEST(Panel, MultipliesLikeTheDenseMatrix) {
  std::mt19937 rng(3);
  std::normal_distribution<double> normal;
  const auto random = [&](std::size_t n) {
    return Eigen::VectorXd(
        Eigen::VectorXd::NullaryExpr(Eigen::Index(n), [&] { return normal(rng); }));
  };
  for (const PanelShape& shape : shapes_of_fronts()) {
    std::vector<double> panel(shape.size());
    for (double& x : panel) x = normal(rng);
    const Eigen::MatrixXd dense = unpacked(panel, shape);

    Eigen::VectorXd x[2] = {random(shape.pivots), random(shape.pivots)};
    Eigen::VectorXd sum[2] = {random(shape.height()), random(shape.height())};
    const Eigen::VectorXd expected[2] = {sum[0] + dense * x[0], sum[1] + dense * x[1]};
    multiply_panel(panel.data(), shape, {x[0].data(), x[1].data()}, {sum[0].data(), sum[1].data()});
    const Eigen::VectorXd back[2] = {dense.transpose() * sum[0], dense.transpose() * sum[1]};
    multiply_transposed(panel.data(), shape, {sum[0].data(), sum[1].data()},
                        {x[0].data(), x[1].data()});
    for (int i : {0, 1}) {
      EXPECT_LT((sum[i] - expected[i]).norm(), 1e-11 * (1 + expected[i].norm()));
      EXPECT_LT((x[i] - back[i]).norm(), 1e-10 * (1 + back[i].norm()));
    }
  }
}

}  // namespace
}  // namespace unwrapd
