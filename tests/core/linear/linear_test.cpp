#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/base/error.hpp"
#include "core/linear/dominant_lu.hpp"
#include "core/linear/eliminate.hpp"
#include "core/linear/factor.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::linear {
namespace {

Eigen::MatrixXd dense_laplacian(const TriMesh& mesh, std::span<const double> weight) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(mesh.vertex_count(), mesh.vertex_count());
  for (std::size_t h = 0; h < weight.size(); ++h) {
    const Index i = mesh.faces[h / 3][h % 3], j = mesh.faces[h / 3][(h + 1) % 3];
    a(i, i) += weight[h], a(j, j) += weight[h];
    a(i, j) -= weight[h], a(j, i) -= weight[h];
  }
  return a;
}

std::vector<double> random_weights(const TriMesh& mesh, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> positive(0.1, 2);
  std::vector<double> weight(3 * mesh.faces.size());
  for (double& w : weight) w = positive(rng);
  return weight;
}

TEST(Laplacian, IsTheLowerTriangleOfTheDenseOne) {
  const TriMesh mesh = shapes::shuffled(shapes::random_disk(7, 3), 4);
  const std::vector<double> weight = random_weights(mesh, 5);
  const SparseMatrix lower = lower_laplacian(mesh.faces, mesh.vertex_count(), weight);
  const Eigen::MatrixXd dense = dense_laplacian(mesh, weight);
  const Eigen::MatrixXd expected = dense.triangularView<Eigen::Lower>();
  EXPECT_LT((Eigen::MatrixXd(lower) - expected).norm(), 1e-12);
  for (Index j = 0; j < mesh.vertex_count(); ++j)  // sorted, the diagonal first
    EXPECT_EQ(SparseMatrix::InnerIterator(lower, j).row(), j);
}

TEST(VertexCorners, ListEveryCornerOnceInOrder) {
  const TriMesh mesh = shapes::shuffled(shapes::random_disk(5, 6), 7);
  const VertexCorners list = vertex_corners(mesh.faces, mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    std::vector<Index> expected;
    for (Index c = 0; c < 3 * mesh.face_count(); ++c)
      if (mesh.faces[std::size_t(c / 3)][std::size_t(c % 3)] == v) expected.push_back(c);
    const std::vector<Index> own(list.corner.begin() + list.begin[std::size_t(v)],
                                 list.corner.begin() + list.begin[std::size_t(v) + 1]);
    EXPECT_EQ(own, expected);
  }
}

TEST(Factor, SolvesBothCoordinatesLikeADenseSolver) {
  const TriMesh mesh = shapes::random_disk(9, 8);
  const std::vector<double> weight = random_weights(mesh, 9);
  SparseMatrix lower = lower_laplacian(mesh.faces, mesh.vertex_count(), weight);
  Eigen::MatrixXd dense = dense_laplacian(mesh, weight);
  lower.coeffRef(3, 3) += 1, dense(3, 3) += 1;
  const Eigen::MatrixX2d b = Eigen::MatrixX2d::Random(mesh.vertex_count(), 2);
  const Eigen::MatrixX2d expected = dense.ldlt().solve(b);
  std::vector<Vec2> x;
  for (Index i = 0; i < mesh.vertex_count(); ++i) x.emplace_back(b.row(i));
  factor(lower)->solve(x);
  for (Index i = 0; i < mesh.vertex_count(); ++i)
    EXPECT_LT((x[std::size_t(i)] - expected.row(i).transpose()).norm(), 1e-9);
}

TEST(Factor, RefusesAnIndefiniteMatrix) {
  SparseMatrix lower(2, 2);
  lower.insert(0, 0) = 1, lower.insert(1, 0) = 2, lower.insert(1, 1) = 1;
  try {
    factor(lower);
    FAIL() << "an indefinite matrix was factored";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::solver_failed);
  }
}

TEST(Factor, SolvesAHermitianSystem) {
  Eigen::MatrixXcd dense(3, 3);
  dense << 4, Complex(0, -1), 1, Complex(0, 1), 5, Complex(1, 1), 1, Complex(1, -1), 6;
  const Eigen::MatrixXcd lower_part = dense.triangularView<Eigen::Lower>();
  const ComplexMatrix lower = lower_part.sparseView().cast<Complex>();
  const Eigen::Vector3cd b(1, Complex(0, 2), Complex(3, 1));
  const Eigen::Vector3cd expected = dense.partialPivLu().solve(b);
  std::vector<Complex> x(b.begin(), b.end());
  factor(lower)->solve(x);
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_LT(std::abs(x[std::size_t(i)] - expected[i]), 1e-13);
}

TEST(DominantLu, SolvesUnsymmetricSystemsLikeADenseSolver) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const TriMesh mesh = shapes::shuffled(shapes::random_disk(4 + Index(seed), seed), seed);
    Eigen::MatrixXd dense = dense_laplacian(mesh, random_weights(mesh, seed + 20));
    const Eigen::VectorXd rows = Eigen::VectorXd::Random(mesh.vertex_count()).array() + 2;
    dense = rows.asDiagonal() * dense;  // no longer symmetric
    dense.diagonal().array() += 0.01;
    const SparseMatrix sparse = dense.sparseView().cast<double>();
    const Eigen::MatrixX2d b = Eigen::MatrixX2d::Random(mesh.vertex_count(), 2);
    const Eigen::MatrixX2d expected = dense.partialPivLu().solve(b);
    std::vector<Vec2> x;
    for (Index i = 0; i < mesh.vertex_count(); ++i) x.emplace_back(b.row(i));
    std::vector<Vec2> on_baseline = x;
    solve_dominant(sparse, x);
    solve_dominant_on_baseline(sparse, on_baseline);
    EXPECT_EQ(x, on_baseline);
    for (Index i = 0; i < mesh.vertex_count(); ++i)
      EXPECT_LT((x[std::size_t(i)] - expected.row(i).transpose()).norm(),
                1e-9 * (1 + expected.norm()));
  }
}

TEST(DominantLu, RefusesASingularMatrix) {
  SparseMatrix zero(2, 2);
  zero.insert(0, 0) = 0, zero.insert(1, 1) = 1;
  std::vector<Vec2> b(2, Vec2(1, 1));
  EXPECT_THROW(solve_dominant(zero, b), Error);
}

TEST(Eliminate, LeavesTheSystemOfTheFreeVertices) {
  const TriMesh mesh = shapes::random_disk(4, 10);
  const std::vector<double> weight = random_weights(mesh, 11);
  const Eigen::MatrixXd dense = dense_laplacian(mesh, weight);
  const auto n = std::size_t(mesh.vertex_count());
  std::vector<char> hard(n, 0);
  std::vector<Vec2> value(n, Vec2(0, 0));
  for (std::size_t v = 0; v < n; v += 3) hard[v] = 1, value[v] = Vec2(double(v), 1);
  const FreeVertices free = number_free(hard);
  auto reduced = eliminate<SparseMatrix, Vec2>(
      lower_laplacian(mesh.faces, mesh.vertex_count(), weight), free, value);
  factor(reduced.lower)->solve(reduced.rhs);
  Eigen::MatrixX2d u(mesh.vertex_count(), 2);
  for (std::size_t v = 0; v < n; ++v)
    u.row(Index(v)) = hard[v] ? value[v] : reduced.rhs[std::size_t(free.slot[v])];
  const Eigen::MatrixX2d residual = dense * u;
  for (std::size_t v = 0; v < n; ++v)
    EXPECT_TRUE(hard[v] || residual.row(Index(v)).norm() < 1e-10) << v;
}

}  // namespace
}  // namespace unwrapd::linear
