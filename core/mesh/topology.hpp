#pragma once
// The topology of a surface: components, Euler characteristic, boundaries, genus.

#include <stop_token>
#include <vector>

#include "core/mesh/halfedges.hpp"

namespace unwrapd {

/// One connected component of a manifold, orientable mesh.
struct Component {
  Index faces = 0;
  Index vertices = 0;
  Index euler = 0;       ///< V - E + F
  Index boundaries = 0;  ///< boundary loops
  Index genus = 0;       ///< (2 - boundaries - euler) / 2

  /// A disk, holes allowed: the input of the solver.
  [[nodiscard]] bool is_disk() const { return boundaries >= 1 && genus == 0; }
};

struct Topology {
  std::vector<Component> components;  ///< ordered by their lowest face
  std::vector<Index> component_of;    ///< one a face
};

/// faces index vertices that each have one fan (see corner_vertices()).
Topology topology(std::span<const Triangle> faces, const Halfedges& halfedges,
                  const std::stop_token& stop = {});

/// The vertices that the twins imply: one for each class of corners that twins connect, so that
/// bow-ties are separated. The faces index new vertices 0..count-1, numbered by first use.
struct CornerVertices {
  std::vector<Triangle> faces;
  Index count = 0;
};
CornerVertices corner_vertices(const Halfedges& halfedges, const std::stop_token& stop = {});

}  // namespace unwrapd
