#pragma once
// What materials do with texture coordinates.

#include <functional>
#include <optional>

#include "core/asset/gltf.hpp"

namespace unwrapd::asset {

/// Calls visit with every textureInfo of a material, those of its extensions too.
void for_each_texture(Json& material, const std::function<void(Json&)>& visit);

/// The set that a textureInfo reads: an override by KHR_texture_transform counts.
std::size_t texcoord_of(const Json& texture);

/// How the textures of a primitive that read gltf.texcoord scale it (KHR_texture_transform): the
/// first that does. Its rotation and offset change no shape and are not in it.
Vec2 texture_scale(const Gltf& gltf, const Primitive& primitive);

/// Whether the primitive has tangents that belong to gltf.texcoord: to the set that its normal map
/// reads, or without one to TEXCOORD_0.
bool loses_tangents(const Gltf& gltf, const Primitive& primitive);

/// Materials that move gltf.texcoord by KHR_texture_transform, though all that they are on is
/// unwrapped.
std::vector<std::size_t> materials_to_reset(const Gltf& gltf);

/// Takes the transforms of gltf.texcoord out of a material; an override of the set stays.
void reset_transforms(Json& material, std::string_view texcoord);

}  // namespace unwrapd::asset
