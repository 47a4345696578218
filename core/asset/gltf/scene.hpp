#pragma once
// What the scene of a document shows.

#include <optional>
#include <span>
#include <vector>

#include "core/asset/gltf/gltf.hpp"
#include "core/mesh/placement.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::asset {

/// In the order of nodes: each surface by every node while that makes no more faces than `most`,
/// else by the first. One that no node shows is left out.
std::vector<ShownSurface> shown_by_nodes(const Gltf& gltf, std::span<const Surface> surfaces,
                                         std::size_t most);

/// One a surface: where the first node shows it; as it is, where none does.
std::vector<Placement> first_placements(const Gltf& gltf, std::span<const Surface> surfaces);

/// How a node shows a surface.
struct ScaledPlacement {
  Placement placement;
  double area_ratio =
      0;  ///< area in the scene over the mesh's own, root mean square over its faces
};

/// One a surface: how the node that shows it largest does, if any. First, for each mesh, the node
/// that shows the whole mesh largest is chosen, so that the cost is nodes + surfaces, not their
/// product.
std::vector<std::optional<ScaledPlacement>> largest_shown(const Gltf& gltf,
                                                          std::span<const Surface> surfaces);

/// How many nodes show nothing but surfaces that nodes before them show.
std::size_t repeated_nodes(const Gltf& gltf);

}  // namespace unwrapd::asset
