#pragma once
// Converts between the formats: geometry, normals and UVs, since OBJ has nothing else.

#include <span>
#include <string>

#include "core/asset/gltf.hpp"
#include "core/asset/obj.hpp"

namespace unwrapd::asset {

/// A minimal glTF: one node, one mesh, one primitive for each material that has faces.
std::string obj_as_gltf(const Obj& obj, const Surface& surface, const UnwrappedSurface& unwrapped,
                        Format output);

/// The vertex of the OBJ that each vertex of that glTF copies.
std::vector<Index> sources_in_gltf(const Obj& obj, const Surface& surface,
                                   const UnwrappedSurface& unwrapped);

/// One object ("o") for each mesh, in the mesh's own space.
std::string gltf_as_obj(const Gltf& gltf, std::span<const Surface> surfaces,
                        std::span<const UnwrappedSurface> unwrapped);

}  // namespace unwrapd::asset
