#pragma once
// Projected Newton on a barrier energy, with a line search that never flips a triangle.

#include <optional>

#include "core/linear/engine.hpp"
#include "core/solve/repair/barrier.hpp"

namespace unwrapd::solve::repair {

/// Minimizes over the free vertices of one mesh. The order of elimination is found once.
class Newton {
 public:
  /// mesh must outlive this, and so must the executor; null: the calling thread alone. The same
  /// bits by any executor.
  explicit Newton(const BarrierMesh& mesh, Executor* executor = nullptr)
      : mesh_(mesh), executor_(executor), model_(barrier_pattern(mesh)) {}

  /// One step. Returns the share by which the energy fell: 0 when it can fall no further. With
  /// epsilon 0 the triangles must be positive, and remain so. Throws Error{too_much_memory,
  /// cancelled}.
  double step(UvMap& uv, const Barrier& barrier);

 private:
  bool factor(Executor& job);
  double search(const UvMap& move, double slope, const Barrier& barrier, UvMap& uv) const;

  const BarrierMesh& mesh_;
  Executor* executor_;
  Quadratic model_;
  std::optional<linear::Factor> factor_;  // its order and memory serve all steps
};

}  // namespace unwrapd::solve::repair
