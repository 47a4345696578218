#pragma once
// Matrices of disks, right-hand sides, and how well these are solved.

#include <cmath>
#include <random>
#include <vector>

#include "core/linear/factor.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::linear {

/// The matrix of the global step, nothing held.
inline SparseMatrix arap_matrix(const solve::Disk& disk) {
  std::vector<double> weight;
  for (const measure::RestTriangle& rest : disk.rest)
    weight.insert(weight.end(), rest.cot.begin(), rest.cot.end());
  SparseMatrix lower = lower_laplacian(disk.faces, disk.vertex_count(), weight);
  lower.coeffRef(0, 0) *= 2;
  return lower;
}

/// Sums to zero, as the forces on a free disk do.
inline std::vector<Vec2> random_forces(const SparseMatrix& lower, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  std::vector<Vec2> b(std::size_t(lower.cols()));
  Vec2 mean = Vec2::Zero();
  for (Vec2& x : b) x = Vec2(normal(rng), normal(rng)), mean += x / double(b.size());
  for (Vec2& x : b) x -= mean;
  return b;
}

inline double norm(const std::vector<Vec2>& x) {
  double sum = 0;
  for (const Vec2& p : x) sum += p.squaredNorm();
  return std::sqrt(sum);
}

inline double gap(std::vector<Vec2> x, const std::vector<Vec2>& y) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] -= y[i];
  return norm(x);
}

inline std::vector<Vec2> solution(const RealSystem& system, std::vector<Vec2> b) {
  system.solve(b);
  return b;
}

/// |A x - b| over |A| |x|: the size of the change of the matrix for which x is the exact solution.
inline double backward_error(const SparseMatrix& lower, const std::vector<Vec2>& x,
                             const std::vector<Vec2>& b) {
  const auto n = Eigen::Index(x.size());
  const Eigen::MatrixX2d dense =
      Eigen::Map<const Eigen::Matrix2Xd>(x.front().data(), 2, n).transpose();
  const Eigen::MatrixX2d ax = lower.selfadjointView<Eigen::Lower>() * dense;
  const Eigen::MatrixX2d right =
      Eigen::Map<const Eigen::Matrix2Xd>(b.front().data(), 2, n).transpose();
  return (ax - right).norm() / (lower.norm() * dense.norm());
}

}  // namespace unwrapd::linear
