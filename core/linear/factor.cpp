// First engine: Eigen's simplicial L L* over an AMD ordering. The triangular solves are ours: both
// coordinates of a vertex go through one sweep over L, where Eigen would sweep once for each.
#include "core/linear/factor.hpp"

#include <Eigen/SparseCholesky>

#include <cassert>
#include <vector>

#include "core/error.hpp"

namespace unwrapd {
namespace {

double conjugate(double x) { return x; }
Complex conjugate(const Complex& x) { return std::conj(x); }

template <typename Scalar, typename Rhs>
class SimplicialSystem final : public PrefactoredSystem<Rhs> {
  using Matrix = Eigen::SparseMatrix<Scalar, Eigen::ColMajor, Index>;

 public:
  explicit SimplicialSystem(const Matrix& lower) : llt_(lower) {}

  [[nodiscard]] bool is_definite() const { return llt_.info() == Eigen::Success; }

  void solve(std::span<Rhs> b) const override {
    const auto& order = llt_.permutationP().indices();  // empty: natural order
    assert(static_cast<Eigen::Index>(b.size()) == llt_.rows());
    std::vector<Rhs> x(b.begin(), b.end());
    for (Eigen::Index i = 0; i < order.size(); ++i)
      x[static_cast<std::size_t>(order[i])] = b[static_cast<std::size_t>(i)];
    forward(x);
    backward(x);
    for (std::size_t i = 0; i < b.size(); ++i)
      b[i] = order.size() > 0 ? x[static_cast<std::size_t>(order[static_cast<Eigen::Index>(i)])]
                              : x[i];
  }

 private:
  const Matrix& factor() const { return llt_.matrixL().nestedExpression(); }

  /// L y = x, column by column; the diagonal is the first entry of each.
  void forward(std::vector<Rhs>& x) const {
    const Matrix& l = factor();
    const Index* begin = l.outerIndexPtr();
    for (std::size_t j = 0; j < x.size(); ++j) {
      const Index first = begin[j];
      const Rhs xj = x[j] / l.valuePtr()[first];
      x[j] = xj;
      for (Index p = first + 1; p < begin[j + 1]; ++p)
        x[static_cast<std::size_t>(l.innerIndexPtr()[p])] -= l.valuePtr()[p] * xj;
    }
  }

  /// L* x = y.
  void backward(std::vector<Rhs>& x) const {
    const Matrix& l = factor();
    const Index* begin = l.outerIndexPtr();
    for (std::size_t j = x.size(); j-- > 0;) {
      const Index first = begin[j];
      Rhs xj = x[j];
      for (Index p = first + 1; p < begin[j + 1]; ++p)
        xj -= conjugate(l.valuePtr()[p]) * x[static_cast<std::size_t>(l.innerIndexPtr()[p])];
      x[j] = xj / conjugate(l.valuePtr()[first]);
    }
  }

  Eigen::SimplicialLLT<Matrix, Eigen::Lower> llt_;
};

template <typename Scalar, typename Rhs, typename Matrix>
std::unique_ptr<PrefactoredSystem<Rhs>> definite_or_null(const Matrix& lower) {
  auto system = std::make_unique<SimplicialSystem<Scalar, Rhs>>(lower);
  if (!system->is_definite()) return nullptr;
  return system;
}

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
  return definite(definite_or_null<double, Vec2>(lower));
}

std::unique_ptr<HermitianSystem> factor(const ComplexMatrix& lower) {
  return definite(try_factor(lower));
}

std::unique_ptr<HermitianSystem> try_factor(const ComplexMatrix& lower) {
  return definite_or_null<Complex, Complex>(lower);
}

}  // namespace unwrapd
