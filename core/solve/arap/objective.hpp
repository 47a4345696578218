#pragma once
// The energy that ARAP and Hybrid minimize: each triangle's energy under its best fit (min over L
// of Eq. 2, 5), plus that of the soft constraints (Sec. 7).

#include <memory>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/solve/arap/local_step.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/base/vertex_constraints.hpp"

namespace unwrapd::solve::arap {

class Objective {
 public:
  /// executor must outlive the objective. rank: GlobalStep::rank(), or any permutation.
  Objective(const Disk& disk, const Rigidity& rigidity, VertexConstraints constraints,
            std::span<const Index> rank, Executor& executor);

  /// Returns E(uv). force becomes -dE/du: zero at fixed vertices. For fixed fits the Hessian of E
  /// is the matrix of GlobalStep, so that one unaccelerated iteration is uv += A^-1 force. Both
  /// spans have one entry a vertex, in rank order. The same for any executor.
  double evaluate(std::span<const Vec2> uv, std::span<Vec2> force);

  /// The area of the images of the last evaluated map, counted with multiplicity.
  [[nodiscard]] double uv_area() const { return uv_area_; }

 private:
  double pull_soft_constraints(std::span<const Vec2> uv, std::span<Vec2> force) const;

  Rigidity rigidity_;
  VertexConstraints holds_;  // in rank order
  Executor& executor_;
  std::shared_ptr<const FaceBlocks> blocks_;
  std::vector<Vec2> beyond_;  // scratch of the local step
  double uv_area_ = 0;
};

}  // namespace unwrapd::solve::arap
