#pragma once
// Geometry of a document that is about to be written, compressed without loss.

#include <string>

#include "core/asset/gltf.hpp"
#include "core/asset/patch.hpp"

namespace unwrapd::asset {

/// KHR_draco_mesh_compression for every primitive of indexed or plain triangles: sequential, so
/// that vertices and faces keep their order, and without quantisation. gltf: a plain document.
/// with_fallback: readers without Draco still find the geometry; none is required.
PatchedDocument draco_compressed(const Gltf& gltf, bool with_fallback);

/// EXT_meshopt_compression, or KHR_ as style says, for every buffer view that holds nothing but
/// vertices or indices. bytes are those of buffer 0, the only one; they become the compressed ones.
/// Triangles may be turned: their corners keep their cyclic order only. Throws Error{cancelled}.
void compress_views(Json& document, std::string& bytes, const MeshoptStyle& style,
                    const std::stop_token& stop);

}  // namespace unwrapd::asset
