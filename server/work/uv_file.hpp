#pragma once
// The answer of core in a file, so that a result can be written again in another format. Arrays of
// native integers and doubles after their counts: read by the same machine that wrote it.

#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::server::work {

std::string encode_uvs(const std::vector<UnwrappedSurface>& surfaces);

/// What encode_uvs() was given. Throws Error{storage_failed} for bytes that it did not write.
std::vector<UnwrappedSurface> decode_uvs(std::string_view bytes);

}  // namespace unwrapd::server::work
