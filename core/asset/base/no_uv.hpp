#pragma once

#include <limits>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::asset {

/// Texture coordinates that are missing or cannot be read.
inline const Vec2 kNoUv = Vec2::Constant(std::numeric_limits<double>::quiet_NaN());
inline const CornerUv kNoCornerUv = {kNoUv, kNoUv, kNoUv};

}  // namespace unwrapd::asset
