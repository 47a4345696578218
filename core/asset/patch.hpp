#pragma once
// Putting the new texture coordinates into a copy of the document.

#include <span>
#include <string>

#include "core/asset/gltf.hpp"

namespace unwrapd::asset {

/// A document that refers to one more buffer than it came with: the last one, `added`.
struct PatchedDocument {
  Json json;
  std::string added;
};

/// gltf.texcoord for every primitive with triangles. Vertices on seams get copies in every
/// attribute; accessors that something else uses as well stay as they are, and new ones take their
/// part.
PatchedDocument patch(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped);

/// For vertex_maps(), where the result is a glTF.
std::vector<VertexMap> vertex_maps_of_patch(const Gltf& gltf,
                                            std::span<const UnwrappedSurface> unwrapped);

/// Sentences for side_effects().
std::vector<std::string> side_effects_of_patch(const Gltf& gltf);

/// The whole file. Where nothing unseen can point into them, bytes that only the replaced parts
/// used are left out. with_meshopt: see compress_views(); it takes a document of one buffer.
/// Throws Error{invalid_option} where buffers cannot become one.
std::string assemble(const Gltf& gltf, PatchedDocument document, Format format,
                     bool with_meshopt = false);

}  // namespace unwrapd::asset
