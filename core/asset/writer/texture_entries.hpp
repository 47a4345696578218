#pragma once
// The entries of new images and textures in a document.

#include <vector>

#include "core/asset/writer/transfer_plan.hpp"

namespace unwrapd::asset::writer {

/// Writes images, textures and samplers, and makes materials refer to them. images: [new image].
/// Entries take the places of those that nothing else refers to, so that old images are left out
/// and numbers stay valid.
void write_entries(const Gltf& gltf, const TransferPlan& plan, std::vector<Json> images,
                   Json& document);

}  // namespace unwrapd::asset::writer
