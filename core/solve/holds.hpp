#pragma once
// Vertices of a disk that are held in the plane (Sec. 7).

#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// A vertex that lies exactly at a place, in disk units.
struct FixedPoint {
  Index vertex = 0;
  Vec2 at = Vec2::Zero();
};

/// A vertex that is drawn to a place: adds weight |u_v - at|^2 to the energy of the disk.
struct Spring {
  Index vertex = 0;
  Vec2 at = Vec2::Zero();
  double weight = 1;  ///< finite, > 0
};

/// No vertex occurs twice.
struct Holds {
  std::vector<FixedPoint> fixed;
  std::vector<Spring> springs;

  [[nodiscard]] bool empty() const { return fixed.empty() && springs.empty(); }
};

}  // namespace unwrapd
