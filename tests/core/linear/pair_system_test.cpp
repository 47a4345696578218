// Two unknowns a vertex, assembled from faces: compared with dense matrices.
#include "core/linear/pair_system.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "tests/core/shapes.hpp"

namespace unwrapd::linear {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Random positive definite elements, one a face.
std::vector<Matrix6> random_elements(std::size_t count, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  std::vector<Matrix6> elements(count);
  for (Matrix6& e : elements) {
    const Matrix6 root = Matrix6::NullaryExpr([&] { return normal(rng); });
    e = root * root.transpose() + Matrix6::Identity();
  }
  return elements;
}

PairElement lower_of(const Matrix6& m) {
  PairElement element{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j <= i; ++j) element[i][j] = m(Index(i), Index(j));
  return element;
}

Eigen::MatrixXd dense(const TriMesh& mesh, const FreeVertices& slots,
                      const std::vector<Matrix6>& elements) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * slots.count, 2 * slots.count);
  for (std::size_t t = 0; t < elements.size(); ++t)
    for (Index i = 0; i < 6; ++i)
      for (Index j = 0; j < 6; ++j) {
        const Index r = slots.slot[std::size_t(mesh.faces[t][std::size_t(i / 2)])];
        const Index c = slots.slot[std::size_t(mesh.faces[t][std::size_t(j / 2)])];
        if (r != kFixed && c != kFixed) a(2 * r + i % 2, 2 * c + j % 2) += elements[t](i, j);
      }
  return a;
}

void add_all(PairSystem& system, const std::vector<Matrix6>& elements) {
  system.clear();
  for (std::size_t t = 0; t < elements.size(); ++t) system.add(t, lower_of(elements[t]));
}

void expect_solves(const TriMesh& mesh, const FreeVertices& slots) {
  PairSystem system(mesh.faces, slots);
  for (unsigned seed : {1U, 2U}) {  // the second time over what the first left behind
    const std::vector<Matrix6> elements = random_elements(mesh.faces.size(), seed);
    add_all(system, elements);
    ASSERT_TRUE(system.factor());
    std::vector<Vec2> b(std::size_t(slots.count));
    for (std::size_t s = 0; s < b.size(); ++s) b[s] = Vec2(double(s % 5) - 2, double(s % 7) - 3);
    Eigen::VectorXd rhs(2 * slots.count);
    for (std::size_t s = 0; s < b.size(); ++s) rhs.segment<2>(2 * Index(s)) = b[s];
    const Eigen::VectorXd expected = dense(mesh, slots, elements).ldlt().solve(rhs);
    system.solve(b);
    for (std::size_t s = 0; s < b.size(); ++s)
      EXPECT_LT((b[s] - expected.segment<2>(2 * Index(s))).norm(), 1e-9);
  }
}

TEST(PairSystem, SolvesLikeADenseMatrix) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const TriMesh mesh = shapes::shuffled(shapes::random_disk(6, seed), seed);
    expect_solves(mesh, number_free(std::vector<char>(mesh.positions.size(), 0)));
  }
}

TEST(PairSystem, LeavesOutVerticesWithoutASlot) {
  const TriMesh mesh = shapes::random_disk(6, 3);
  std::vector<char> hard(mesh.positions.size(), 0);
  for (std::size_t v = 0; v < hard.size(); v += 3) hard[v] = 1;
  expect_solves(mesh, number_free(hard));
}

TEST(PairSystem, LetsVerticesShareASlot) {  // also two corners of one face
  const TriMesh mesh = shapes::random_disk(6, 4);
  FreeVertices slots = number_free(std::vector<char>(mesh.positions.size(), 0));
  for (std::size_t v : {8U, 9U, 10U, 17U, 24U}) slots.slot[v] = slots.slot[8];
  // slots that nobody is left in would be rows of zeros
  FreeVertices dense_slots{slots.slot, 0};
  std::vector<Index> number(mesh.positions.size(), kFixed);
  for (Index& s : dense_slots.slot) {
    if (number[std::size_t(s)] == kFixed) number[std::size_t(s)] = dense_slots.count++;
    s = number[std::size_t(s)];
  }
  expect_solves(mesh, dense_slots);
}

TEST(PairSystem, RaisesTheDiagonalOfASingularMatrix) {
  const TriMesh mesh = shapes::grid(1, 1);
  const FreeVertices slots = number_free(std::vector<char>(4, 0));
  PairSystem system(mesh.faces, slots);
  add_all(system, {2, Matrix6::Ones()});  // rank 2 of 8
  EXPECT_TRUE(system.factor());
  std::vector<Vec2> b(4, Vec2(1, 1));
  system.solve(b);
  for (const Vec2& x : b) EXPECT_TRUE(x.allFinite());
}

TEST(PairSystem, RefusesAnIndefiniteMatrix) {
  const TriMesh mesh = shapes::grid(1, 1);
  const FreeVertices slots = number_free(std::vector<char>(4, 0));
  PairSystem system(mesh.faces, slots);
  add_all(system, {2, -Matrix6::Identity()});
  EXPECT_FALSE(system.factor());
}

}  // namespace
}  // namespace unwrapd::linear
