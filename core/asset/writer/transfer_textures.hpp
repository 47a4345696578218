#pragma once
// Paints the images that sample the replaced set for the new texture coordinates.

#include <span>
#include <vector>

#include "core/asset/gltf/new_accessors.hpp"
#include "core/asset/writer/texture_frames.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset::writer {

/// Replaces images, textures, samplers and materials in a patched document. Primitives that read an
/// image in different ways get materials of their own. Transforms of the set are removed. Throws
/// Error{too_much_memory}, Error{malformed_image}, Error{cancelled}.
void transfer_textures(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped,
                       const WrittenTangents& tangents, Json& document, NewViews& views);

/// What was done, for the user.
std::vector<Note> notes_on_transfer(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped);

}  // namespace unwrapd::asset::writer
