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

/// TEXCOORD_0 for every primitive with triangles. Vertices on seams get copies in every attribute;
/// accessors that something else uses as well stay as they are, and new ones take their part.
PatchedDocument patch(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped);

/// The whole file. Where nothing unseen can point into them, bytes that only the replaced parts
/// used are left out.
std::string assemble(const Gltf& gltf, PatchedDocument document, Format format);

}  // namespace unwrapd::asset
