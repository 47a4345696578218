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

/// A placement that shows a surface.
struct Shown {
  Placement placement;
  double area = 0;  ///< of the surface there, in shares of its own, by the rms over its faces
};

/// One a surface: the placement that shows it largest, or none. Of a mesh, the node that shows all
/// its surfaces largest counts, so that nodes and surfaces do not multiply.
std::vector<std::optional<Shown>> largest_shown(const Gltf& gltf,
                                                std::span<const Surface> surfaces);

/// How many nodes show nothing but surfaces that nodes before them show.
std::size_t repeated_nodes(const Gltf& gltf);

}  // namespace unwrapd::asset
