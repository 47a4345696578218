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

/// The placement that shows a mesh largest. One a mesh, so that its nodes and its surfaces do not
/// multiply; none where no node shows it.
std::vector<std::optional<Placement>> largest_by_mesh(const Gltf& gltf);

/// The meshes of which each of so many surfaces has faces: its own, and those with the same
/// geometry.
std::vector<std::vector<std::size_t>> meshes_of_surfaces(const Gltf& gltf, std::size_t count);

/// How many nodes show nothing but surfaces that nodes before them show.
std::size_t repeated_nodes(const Gltf& gltf);

}  // namespace unwrapd::asset
