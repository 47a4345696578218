// Real systems go to our own engine (engine.hpp), Hermitian ones to Eigen's simplicial L L* over an
// AMD ordering, which has no supernodes but needs no code for complex fronts.
#include "core/linear/factor.hpp"

#include <Eigen/SparseCholesky>

#include <cassert>
#include <vector>

#include "core/error.hpp"
#include "core/linear/engine.hpp"

namespace unwrapd {
namespace {

class SimplicialSystem final : public HermitianSystem {
 public:
  explicit SimplicialSystem(const ComplexMatrix& lower) : llt_(lower) {}

  [[nodiscard]] bool is_definite() const { return llt_.info() == Eigen::Success; }

  void solve(std::span<Complex> b) const override {
    const auto& order = llt_.permutationP().indices();  // empty: natural order
    assert(static_cast<Eigen::Index>(b.size()) == llt_.rows());
    std::vector<Complex> x(b.begin(), b.end());
    for (Eigen::Index i = 0; i < order.size(); ++i)
      x[static_cast<std::size_t>(order[i])] = b[static_cast<std::size_t>(i)];
    forward(x);
    backward(x);
    for (std::size_t i = 0; i < b.size(); ++i)
      b[i] = order.size() > 0 ? x[static_cast<std::size_t>(order[static_cast<Eigen::Index>(i)])]
                              : x[i];
  }

 private:
  const ComplexMatrix& factor() const { return llt_.matrixL().nestedExpression(); }

  /// L y = x, column by column; the diagonal is the first entry of each.
  void forward(std::vector<Complex>& x) const {
    const ComplexMatrix& l = factor();
    const Index* begin = l.outerIndexPtr();
    for (std::size_t j = 0; j < x.size(); ++j) {
      const Index first = begin[j];
      const Complex xj = x[j] / l.valuePtr()[first];
      x[j] = xj;
      for (Index p = first + 1; p < begin[j + 1]; ++p)
        x[static_cast<std::size_t>(l.innerIndexPtr()[p])] -= l.valuePtr()[p] * xj;
    }
  }

  /// L* x = y.
  void backward(std::vector<Complex>& x) const {
    const ComplexMatrix& l = factor();
    const Index* begin = l.outerIndexPtr();
    for (std::size_t j = x.size(); j-- > 0;) {
      const Index first = begin[j];
      Complex xj = x[j];
      for (Index p = first + 1; p < begin[j + 1]; ++p)
        xj -= std::conj(l.valuePtr()[p]) * x[static_cast<std::size_t>(l.innerIndexPtr()[p])];
      x[j] = xj / std::conj(l.valuePtr()[first]);
    }
  }

  Eigen::SimplicialLLT<ComplexMatrix, Eigen::Lower> llt_;
};

template <typename System>
System definite(System system) {
  if (!system)
    throw Error(ErrorCode::solver_failed,
                "the mesh's matrix is not positive definite in double precision; remove needle "
                "and zero-area triangles and try again");
  return system;
}

}  // namespace

std::unique_ptr<RealSystem> factor(const SparseMatrix& lower) {
  SparseMatrix compressed;
  if (!lower.isCompressed()) {
    compressed = lower;
    compressed.makeCompressed();
  }
  const SparseMatrix& matrix = lower.isCompressed() ? lower : compressed;
  return definite(try_factor(analyse(matrix), matrix));
}

std::unique_ptr<HermitianSystem> factor(const ComplexMatrix& lower) {
  return definite(try_factor(lower));
}

std::unique_ptr<HermitianSystem> try_factor(const ComplexMatrix& lower) {
  auto system = std::make_unique<SimplicialSystem>(lower);
  if (!system->is_definite()) return nullptr;
  return system;
}

}  // namespace unwrapd
