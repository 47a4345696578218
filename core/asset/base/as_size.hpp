#pragma once
// Converts mesh indices, which are 32-bit and signed, to sizes of containers.

#include <cstddef>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::asset {

inline std::size_t as_size(Index index) { return static_cast<std::size_t>(index); }

}  // namespace unwrapd::asset
