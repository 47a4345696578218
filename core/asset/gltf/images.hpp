#pragma once
// Images of a .gltf in files beside it. A GLB may be moved without them, so images that were sent
// are included.

#include <string_view>

#include "core/asset/gltf/new_accessors.hpp"

namespace unwrapd::asset {

/// The type by the first bytes; empty for a type that a buffer view must not have.
std::string_view media_type(std::string_view image);

/// Adds the images that were sent to buffer views of the patched document.
void embed_images(const Gltf& gltf, Json& document, NewViews& views);

/// The images that stay in files beside the document: one of their URIs, and their number.
struct FilesBeside {
  std::string first;
  std::size_t count = 0;
};
FilesBeside images_beside(const Gltf& gltf);

}  // namespace unwrapd::asset
