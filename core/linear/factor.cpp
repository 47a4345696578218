// All systems use our own engine (engine.hpp); Hermitian ones are real ones of twice the size. This
// takes twice the memory and arithmetic of complex fronts, but is several times faster than Eigen's
// simplicial factor, and needs no second set of kernels.
#include "core/linear/factor.hpp"

#include <utility>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/linear/engine.hpp"

namespace unwrapd::linear {
namespace {

class PairsSystem final : public HermitianSystem {
 public:
  explicit PairsSystem(std::unique_ptr<Factor> factor) : factor_(std::move(factor)) {}

  void solve(std::span<Complex> b, const std::stop_token& stop) const override {
    std::vector<Vec2> x;
    x.reserve(b.size());
    for (const Complex& z : b) x.emplace_back(z.real(), z.imag());
    factor_->solve_pairs(x, stop);
    for (std::size_t v = 0; v < b.size(); ++v) b[v] = {x[v].x(), x[v].y()};
  }

 private:
  std::unique_ptr<Factor> factor_;
};

}  // namespace

void refuse_indefinite() {
  throw Error(ErrorCode::solver_failed,
              "the mesh's matrix is not positive definite in double precision; remove needle and "
              "zero-area triangles and try again");
}

SparseMatrix as_pairs(const ComplexMatrix& lower, const std::stop_token& stop) {
  const auto n = static_cast<Index>(lower.cols());
  SparseMatrix pairs(2 * n, 2 * n);
  pairs.reserve(4 * lower.nonZeros());
  for (Index j = 0; j < 2 * n; ++j) {
    check_cancelled_every(j, stop);
    pairs.startVec(j);
    for (ComplexMatrix::InnerIterator it(lower, j / 2); it; ++it) {
      const Complex entry = j % 2 == 0 ? it.value() : it.value() * Complex(0, 1);
      const auto row = 2 * static_cast<Index>(it.row());
      if (row >= j) pairs.insertBack(row, j) = entry.real();
      pairs.insertBack(row + 1, j) = entry.imag();
    }
  }
  pairs.finalize();
  return pairs;
}

std::unique_ptr<RealSystem> factor(const SparseMatrix& lower, const std::stop_token& stop) {
  SparseMatrix compressed;
  if (!lower.isCompressed()) {
    compressed = lower;
    compressed.makeCompressed();
  }
  const SparseMatrix& matrix = lower.isCompressed() ? lower : compressed;
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  return definite(try_factor(analyse(matrix, stop), matrix, job));
}

std::unique_ptr<HermitianSystem> factor(const ComplexMatrix& lower) {
  return definite(try_factor(lower));
}

std::unique_ptr<HermitianSystem> try_factor(const ComplexMatrix& lower, const MemoryCheck& check,
                                            const std::stop_token& stop) {
  const SparseMatrix pairs = as_pairs(lower, stop);
  const auto analysis = analyse_pairs(pairs, stop);
  if (check) check(analysis->job_bytes());
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  std::unique_ptr<Factor> system = try_factor(analysis, pairs, job);
  if (!system) return nullptr;
  return std::make_unique<PairsSystem>(std::move(system));
}

}  // namespace unwrapd::linear
