#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "core/linear/front.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::linear {
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

TEST(Front, GivesTheSameBitsWhenThreadsShareIt) {
  TwoThreads two;
  for (const PanelShape shape : {PanelShape{70, 150}, {130, 63}, {203, 0}, {64, 200}}) {
    const Eigen::MatrixXd a = random_definite(Eigen::Index(shape.pivots + shape.below), 7);
    Front alone, shared;
    std::vector<double> panel(shape.size()), panel_of_two(shape.size());
    fill(alone, shape, a);
    fill(shared, shape, a);
    ASSERT_TRUE(alone.factor(panel.data()));
    ASSERT_TRUE(shared.factor(panel_of_two.data(), two));
    EXPECT_EQ(panel, panel_of_two);
    const std::size_t end = alone.update_begin() + shape.below;
    for (std::size_t j = alone.update_begin(); j < end; ++j)
      EXPECT_TRUE(std::equal(alone.diagonal(j), alone.diagonal(j) + (end - j), shared.diagonal(j)));
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

struct PanelCase {
  PanelShape shape;
  std::vector<double> panel, rows;  // of both right-hand sides, as PanelRows
  std::vector<Vec2> x;
};

PanelCase random_case(PanelShape shape, std::mt19937& rng) {
  std::normal_distribution<double> normal;
  PanelCase c{
      shape, std::vector<double>(shape.size()), std::vector<double>(2 * shape.height()), {}};
  for (double& number : c.panel) number = normal(rng);
  for (double& number : c.rows) number = normal(rng);
  for (std::size_t k = 0; k < shape.pivots; ++k) c.x.emplace_back(normal(rng), normal(rng));
  return c;
}

Eigen::MatrixX2d dense_rows(const std::vector<double>& rows) {
  Eigen::MatrixX2d dense(Eigen::Index(rows.size() / 2), 2);
  for (std::size_t r = 0; r < rows.size() / 2; ++r)
    dense.row(Eigen::Index(r)) << rows[row_entry(r)], rows[row_entry(r) + kDuo];
  return dense;
}

Eigen::MatrixX2d dense_pivots(const std::vector<Vec2>& x) {
  Eigen::MatrixX2d dense(Eigen::Index(x.size()), 2);
  for (std::size_t k = 0; k < x.size(); ++k) dense.row(Eigen::Index(k)) = x[k].transpose();
  return dense;
}

TEST(Panel, MultipliesLikeTheDenseMatrix) {
  std::mt19937 rng(3);
  for (const PanelShape& shape : shapes_of_fronts()) {
    PanelCase c = random_case(shape, rng);
    const Eigen::MatrixXd dense = unpacked(c.panel, shape);
    const Eigen::MatrixX2d sum = dense * dense_pivots(c.x);
    panel_kernels().multiply(c.panel.data(), shape, c.x.data(), c.rows.data());
    EXPECT_LT((dense_rows(c.rows) - sum).norm(), 1e-11 * (1 + sum.norm()));
    const Eigen::MatrixX2d back = dense.transpose() * sum;
    panel_kernels().multiply_transposed(c.panel.data(), shape, c.rows.data(), c.x.data());
    EXPECT_LT((dense_pivots(c.x) - back).norm(), 1e-10 * (1 + back.norm()));
  }
}

TEST(Panel, MultipliesToTheSameBitsOnTheBaseline) {
  std::mt19937 rng(4);
  for (const PanelShape& shape : shapes_of_fronts()) {
    PanelCase wide = random_case(shape, rng), narrow = wide;
    for (auto [kernels, c] :
         {std::pair{panel_kernels(), &wide}, std::pair{baseline_panel_kernels(), &narrow}}) {
      kernels.multiply(c->panel.data(), shape, c->x.data(), c->rows.data());
      kernels.multiply_transposed(c->panel.data(), shape, c->rows.data(), c->x.data());
    }
    EXPECT_EQ(wide.rows, narrow.rows);
    EXPECT_EQ(wide.x, narrow.x);
  }
}

}  // namespace
}  // namespace unwrapd::linear
