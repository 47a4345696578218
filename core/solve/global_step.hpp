#pragma once
// The global step: all fitted triangles are stitched together by one linear solve (Sec. 4.4.2).

#include <memory>
#include <span>

#include "core/executor.hpp"
#include "core/linear/factor.hpp"
#include "core/solve/disk.hpp"

namespace unwrapd {

/// The matrix of Eq. (4) with vertex 0 pinned, factored once. It depends on the mesh alone.
class GlobalStep {
 public:
  /// Throws Error{solver_failed}. disk must outlive the step.
  explicit GlobalStep(const Disk& disk);

  /// Moves uv to the minimiser of Eq. (1) for the fits whose residual local_step() left: uv becomes
  /// uv + A^-1 r, r the residual summed over each vertex's corners. Solving for the change, not for
  /// the map, keeps full precision near convergence.
  void advance(std::span<const Vec2> residual, std::span<Vec2> uv, Executor& executor) const;

  [[nodiscard]] const Disk& disk() const { return disk_; }

 private:
  const Disk& disk_;
  std::unique_ptr<RealSystem> system_;
};

}  // namespace unwrapd
