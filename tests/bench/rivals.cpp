#include "tests/bench/rivals.hpp"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>

#include "core/linear/engine.hpp"

#ifdef UNWRAPD_HAS_CHOLMOD
#include <cholmod.h>
#endif

namespace unwrapd::bench {
namespace {

constexpr int kSolves = 9;

/// Milliseconds of the processor that a call takes.
template <typename Call>
double milliseconds(Call call) {
  const std::clock_t start = std::clock();
  call();
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

template <typename Call>
double median_milliseconds(Call call) {
  std::array<double, kSolves> took{};
  for (double& t : took) t = milliseconds(call);
  std::sort(took.begin(), took.end());
  return took[kSolves / 2];
}

template <typename Matrix>
Times time_simplicial(const Matrix& lower, Eigen::Index columns) {
  using Dense = Eigen::Matrix<typename Matrix::Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  Eigen::SimplicialLLT<Matrix, Eigen::Lower> llt;
  Dense b = Dense::Ones(lower.cols(), columns);
  Times times;
  times.analysis = milliseconds([&] { llt.analyzePattern(lower); });
  times.factor = milliseconds([&] { llt.factorize(lower); });
  times.refactor = milliseconds([&] { llt.factorize(lower); });
  if (llt.info() != Eigen::Success) std::abort();
  times.solve = median_milliseconds([&] { b = llt.solve(b).eval(); });
  const auto entries = static_cast<double>(Matrix(llt.matrixL()).nonZeros());
  times.megabytes = 1e-6 * (sizeof(typename Matrix::Scalar) + sizeof(Index)) * entries;
  return times;
}

}  // namespace

Times time_ours(const linear::SparseMatrix& lower, Unknowns unknowns) {
  const bool is_pairs = unknowns == Unknowns::pairs;
  std::shared_ptr<const linear::Analysis> analysis;
  std::optional<linear::Factor> factor;
  bool is_definite = false;
  Times times;
  times.analysis = milliseconds(
      [&] { analysis = is_pairs ? linear::analyse_pairs(lower) : linear::analyse(lower); });
  times.factor = milliseconds([&] { is_definite = factor.emplace(analysis).refill(lower); });
  times.refactor = milliseconds([&] { is_definite = factor->refill(lower) && is_definite; });
  if (!is_definite) std::abort();
  std::vector<Vec2> b(static_cast<std::size_t>(lower.cols()) / (is_pairs ? 2 : 1), Vec2(1, -1));
  times.solve = median_milliseconds([&] { is_pairs ? factor->solve_pairs(b) : factor->solve(b); });
  times.megabytes = 8e-6 * static_cast<double>(analysis->panel_begin.back()) +
                    4e-6 * static_cast<double>(analysis->nodes.row.size());
  return times;
}

Times time_eigen(const linear::SparseMatrix& lower, Unknowns unknowns) {
  return time_simplicial(lower, unknowns == Unknowns::pairs ? 1 : 2);
}

Times time_eigen(const linear::ComplexMatrix& lower) { return time_simplicial(lower, 1); }

#ifdef UNWRAPD_HAS_CHOLMOD

std::optional<Times> time_cholmod(const linear::SparseMatrix& lower, Unknowns unknowns) {
  cholmod_common common;
  cholmod_start(&common);
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_AMD;
  common.supernodal = CHOLMOD_SUPERNODAL;
  linear::SparseMatrix copy = lower;
  const auto n = static_cast<std::size_t>(lower.cols());
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = n;
  matrix.nzmax = static_cast<std::size_t>(lower.nonZeros());
  matrix.p = copy.outerIndexPtr(), matrix.i = copy.innerIndexPtr(), matrix.x = copy.valuePtr();
  matrix.stype = -1, matrix.itype = CHOLMOD_INT, matrix.xtype = CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE, matrix.sorted = 1, matrix.packed = 1;
  cholmod_dense* b = cholmod_ones(n, unknowns == Unknowns::pairs ? 1 : 2, CHOLMOD_REAL, &common);
  cholmod_factor* factor = nullptr;
  cholmod_dense *x = nullptr, *y = nullptr, *e = nullptr;
  Times times;
  times.analysis = milliseconds([&] { factor = cholmod_analyze(&matrix, &common); });
  times.factor = milliseconds([&] { cholmod_factorize(&matrix, factor, &common); });
  times.refactor = milliseconds([&] { cholmod_factorize(&matrix, factor, &common); });
  times.solve = median_milliseconds(
      [&] { cholmod_solve2(CHOLMOD_A, factor, b, nullptr, &x, nullptr, &y, &e, &common); });
  times.megabytes = 8e-6 * static_cast<double>(factor->xsize);
  for (cholmod_dense** dense : {&b, &x, &y, &e}) cholmod_free_dense(dense, &common);
  cholmod_free_factor(&factor, &common);
  cholmod_finish(&common);
  return times;
}

#else

std::optional<Times> time_cholmod(const linear::SparseMatrix&, Unknowns) { return std::nullopt; }

#endif

}  // namespace unwrapd::bench
