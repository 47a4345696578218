#pragma once
// Mesh indices are 32-bit and signed, the sizes of containers neither: the one conversion.

#include <cstddef>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::asset {

inline std::size_t as_size(Index index) { return static_cast<std::size_t>(index); }

}  // namespace unwrapd::asset
