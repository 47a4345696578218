#pragma once
// Images of a .gltf in files beside it. A GLB may be moved without them, so what was sent along is
// taken into it.

#include "core/asset/grow.hpp"

namespace unwrapd::asset {

/// Puts the images that were sent along into buffer views of the patched document.
void embed_images(const Gltf& gltf, Json& document, NewViews& views);

/// Those that stay in files beside the document; one of their URIs, and how many there are.
struct FilesBeside {
  std::string first;
  std::size_t count = 0;
};
FilesBeside images_beside(const Gltf& gltf);

}  // namespace unwrapd::asset
