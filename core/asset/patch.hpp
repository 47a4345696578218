#pragma once
// Writes the new texture coordinates into a copy of the document.

#include <optional>
#include <span>
#include <string>

#include "core/asset/gltf.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset {

/// A document with one more buffer than its input: the last one, `added`.
struct PatchedDocument {
  Json json;
  std::string added;
  const Aside* aside = nullptr;  ///< members that are written in addition to json
};

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

/// The form of meshopt's compression in a document.
struct MeshoptStyle {
  std::string name = "EXT_meshopt_compression";
  bool with_fallback =
      false;  ///< includes the uncompressed bytes, and no reader needs the extension
};

/// The whole file. Bytes that only the replaced parts used are left out, unless an unknown
/// extension may refer to them. meshopt: see compress_views(); it takes a document of one buffer.
/// Throws Error{invalid_option} if the buffers cannot be joined.
std::string assemble(const Gltf& gltf, PatchedDocument document, Format format,
                     const std::optional<MeshoptStyle>& meshopt = {});

}  // namespace unwrapd::asset
