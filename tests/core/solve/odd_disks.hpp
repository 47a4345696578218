#pragma once
// Disks that strain angles: slivers, needles, fans, tips, holes.

#include <string>
#include <vector>

#include "tests/core/shapes.hpp"

namespace unwrapd::odd {

struct NamedMesh {
  std::string name;
  TriMesh mesh;
};

/// A bumpy disk from which one quad in sixteen is missing.
inline TriMesh pierced_disk(Index n, unsigned seed) {
  TriMesh mesh = shapes::random_disk(n, seed);
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    const Index column = Index(t / 2) % n, row = Index(t / 2) / n;
    if (column % 4 != 2 || row % 4 != 2) kept.push_back(mesh.faces[t]);
  }
  mesh.faces = std::move(kept);
  return mesh;
}

/// A bumpy disk, its width multiplied.
inline TriMesh squeezed(double width) {
  TriMesh mesh = shapes::random_disk(8, 1);
  for (Vec3& p : mesh.positions) p.x() *= width;
  return mesh;
}

/// A bumpy disk with one inner vertex drawn onto its neighbour, but for a share of the way.
inline TriMesh pinched(double share) {
  TriMesh mesh = shapes::random_disk(8, 2);
  mesh.positions[41] = mesh.positions[40] + share * (mesh.positions[41] - mesh.positions[40]);
  return mesh;
}

inline std::vector<NamedMesh> hard_disks() {
  return {{"one triangle", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}},
          {"no inner vertex", shapes::half_cylinder(5, 1)},
          {"a tip of 300 faces", shapes::cone(300, 1, 0.5)},
          {"slivers of 1:1e3", squeezed(1e-3)},
          {"a needle of 1e-4", pinched(1e-4)},
          {"a needle below the floor", pinched(1e-9)},
          {"holes", pierced_disk(12, 5)},
          {"a deep cap", shapes::sphere_cap(24, 10, 2.6)}};
}

}  // namespace unwrapd::odd
