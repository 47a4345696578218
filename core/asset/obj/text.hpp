#pragma once
// Statements of an OBJ as text.

#include <string>

#include "core/asset/base/colour.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::asset::obj {

/// " v/vt/vn" from indices that count from 0; negative ones are left out.
void append_indices(std::string& out, Index vertex, Index texcoord, Index normal);

void append_vt(std::string& out, const Vec2& uv);

void append_vn(std::string& out, const Vec3& normal);

/// colour: null for none; channels that are not known are written as 1. An OBJ has no place for
/// alpha.
void append_v(std::string& out, const Vec3& position, const Colour* colour);

}  // namespace unwrapd::asset::obj
