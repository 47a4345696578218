#pragma once
// Writes the new texture coordinates into a copy of the document.

#include <optional>
#include <span>
#include <string>

#include "core/asset/codec/compress.hpp"
#include "core/asset/gltf/gltf.hpp"
#include "core/asset/gltf/new_accessors.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset::writer {

/// Sets gltf.texcoord of every primitive with triangles. Vertices on seams get copies in every
/// attribute. Accessors with other users stay as they are and are replaced by new ones. output: a
/// GLB includes the images that were sent with a .gltf.
PatchedDocument patch(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped, Format output);

/// The result of vertex_maps() for a glTF.
std::vector<VertexMap> vertex_maps_of_patch(const Gltf& gltf,
                                            std::span<const UnwrappedSurface> unwrapped);

/// The lower sets of texture coordinates that the primitive lacks: a document must not skip any.
std::vector<std::string> missing_sets(const Gltf& gltf, const Primitive& primitive);

/// Notes for side_effects().
std::vector<Note> side_effects_of_patch(const Gltf& gltf,
                                        std::span<const UnwrappedSurface> unwrapped, Format output);

/// The whole file. Bytes that only the replaced parts used are left out, unless an unknown
/// extension may refer to them. meshopt: see compress_views(); it takes a document of one buffer.
/// Throws Error{invalid_option} if the buffers cannot be joined.
std::string assemble(const Gltf& gltf, PatchedDocument document, Format format,
                     const std::optional<codec::MeshoptStyle>& meshopt = {});

}  // namespace unwrapd::asset::writer
