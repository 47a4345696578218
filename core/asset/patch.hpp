#pragma once
// Putting the new texture coordinates into a copy of the document.

#include <optional>
#include <span>
#include <string>

#include "core/asset/gltf.hpp"

namespace unwrapd::asset {

/// A document that refers to one more buffer than it came with: the last one, `added`.
struct PatchedDocument {
  Json json;
  std::string added;
  const Aside* aside = nullptr;  ///< what goes beside json into the file
};

/// gltf.texcoord for every primitive with triangles. Vertices on seams get copies in every
/// attribute; accessors that something else uses as well stay as they are, and new ones take their
/// part. output: a GLB takes the images of a .gltf along that were sent with it.
PatchedDocument patch(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped, Format output);

/// For vertex_maps(), where the result is a glTF.
std::vector<VertexMap> vertex_maps_of_patch(const Gltf& gltf,
                                            std::span<const UnwrappedSurface> unwrapped);

/// Sentences for side_effects().
std::vector<std::string> side_effects_of_patch(const Gltf& gltf, Format output);

/// How meshopt's compression is written into a document.
struct MeshoptStyle {
  std::string name = "EXT_meshopt_compression";
  bool with_fallback = false;  ///< the plain bytes go along, and no reader needs the extension
};

/// The whole file. Where nothing unseen can point into them, bytes that only the replaced parts
/// used are left out. meshopt: see compress_views(); it takes a document of one buffer.
/// Throws Error{invalid_option} where buffers cannot become one.
std::string assemble(const Gltf& gltf, PatchedDocument document, Format format,
                     const std::optional<MeshoptStyle>& meshopt = {});

}  // namespace unwrapd::asset
