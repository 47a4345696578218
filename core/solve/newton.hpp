#pragma once
// Projected Newton on a barrier energy, with a line search that never lets a triangle flip.

#include <memory>

#include "core/linear/engine.hpp"
#include "core/solve/barrier.hpp"

namespace unwrapd {

/// One mesh whose free vertices are moved downhill. The order of elimination is found once.
class Newton {
 public:
  /// mesh must outlive this.
  explicit Newton(const BarrierMesh& mesh) : mesh_(mesh), model_(barrier_pattern(mesh)) {}

  /// One step. Returns the share by which the energy fell: 0 when it can fall no further. With
  /// epsilon 0 the triangles must be positive, and remain so. Throws Error{cancelled}.
  double step(UvMap& uv, const Barrier& barrier);

 private:
  std::unique_ptr<RealSystem> factor();
  double search(const UvMap& move, double slope, const Barrier& barrier, UvMap& uv) const;

  const BarrierMesh& mesh_;
  Quadratic model_;
  std::shared_ptr<const Analysis> analysis_;
};

}  // namespace unwrapd
