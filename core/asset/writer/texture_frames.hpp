#pragma once
// The tangent frames in which normal maps are read, before and after.

#include <array>
#include <map>
#include <span>
#include <vector>

#include "core/asset/writer/cut.hpp"
#include "core/asset/writer/transfer_plan.hpp"

namespace unwrapd::asset::writer {

/// The tangents that the written file has: [piece][face][corner], where it has any.
using WrittenTangents = std::map<std::size_t, std::vector<std::array<Tangent, 3>>>;

/// Adds those of a pool after its cut.
void add_tangents(const Cut& cut, WrittenTangents& written);

/// Fills the frames of a patch: the file's tangents where it has them, and else those that a reader
/// computes by MikkTSpace from the coordinates that the normal map is sampled at. Throws
/// Error{cancelled}.
void set_frames(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped,
                const TextureUse& use, const WrittenTangents& written, texture::Patch& patch);

}  // namespace unwrapd::asset::writer
