#pragma once
// Meshes that their nodes stretch.

#include <span>
#include <vector>

#include "core/asset/gltf/gltf.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset {

/// A note on surfaces that come out longer in one direction than in another where nodes show them,
/// by more than a map of bounded distortion would be; empty if there are none.
std::vector<Note> notes_on_stretched(const Gltf& gltf, std::span<const Surface> surfaces);

}  // namespace unwrapd::asset
