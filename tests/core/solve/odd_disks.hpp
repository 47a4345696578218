#pragma once
// Disks that strain angles: slivers, needles, fans, tips, holes.

#include <vector>

#include "tests/core/hard_shapes.hpp"

namespace unwrapd::odd {

/// A bumpy disk with one inner vertex drawn onto its neighbour, but for a share of the way.
inline TriMesh pinched(double share) {
  TriMesh mesh = shapes::random_disk(8, 2);
  mesh.positions[41] = mesh.positions[40] + share * (mesh.positions[41] - mesh.positions[40]);
  return mesh;
}

inline std::vector<shapes::NamedMesh> hard_disks() {
  return {{"one triangle", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}},
          {"no inner vertex", shapes::half_cylinder(5, 1)},
          {"a tip of 300 faces", shapes::cone(300, 1, 0.5)},
          {"slivers of 1:1e3", shapes::slivers(8, 1, 1e-3)},
          {"a needle of 1e-4", pinched(1e-4)},
          {"a needle below the floor", pinched(1e-9)},
          {"holes", shapes::pierced_disk(12, 5)},
          {"a deep cap", shapes::sphere_cap(24, 10, 2.6)}};
}

}  // namespace unwrapd::odd
