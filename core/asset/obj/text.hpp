#pragma once
// Statements of an OBJ as text.

#include <string>
#include <string_view>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::asset::obj {

/// " v/vt/vn" from indices that count from 0; negative ones are left out.
void append_indices(std::string& out, Index vertex, Index texcoord, Index normal);

void append_vt(std::string& out, const Vec2& uv);

/// keyword: "v" or "vn".
void append_vec3(std::string& out, std::string_view keyword, const Vec3& value);

}  // namespace unwrapd::asset::obj
