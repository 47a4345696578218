#pragma once
// The filters of EXT_meshopt_compression that turn compact codes into unit vectors and quaternions.
// Evaluated in double precision and rounded once, as the specification's formulas say: vectorised
// code with approximate square roots is a unit off here and there.

#include <cstddef>
#include <span>

namespace unwrapd::asset {

/// Octahedral codes (x, y, one, w) of 4 or 8 bytes become vectors (x, y, z, w) of the same size.
/// bytes: whole elements.
void decode_octahedral(std::span<char> bytes, std::size_t stride);

/// The three smallest components of each quaternion, and which one is left out, become all four.
/// bytes: whole elements of 8 bytes.
void decode_quaternions(std::span<char> bytes);

}  // namespace unwrapd::asset
