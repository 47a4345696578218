#pragma once
// The filters of EXT_meshopt_compression that turn compact codes into unit vectors and quaternions.
// Computed in double precision and rounded once, by the specification's formulas; vectorised code
// with approximate square roots is sometimes one unit off.

#include <cstddef>
#include <span>

namespace unwrapd::asset::codec {

/// Octahedral codes (x, y, one, w) of 4 or 8 bytes become vectors (x, y, z, w) of the same size.
/// bytes: whole elements.
void decode_octahedral(std::span<char> bytes, std::size_t stride);

/// Restores all four components of each quaternion from the three smallest and the number of the
/// fourth. bytes: whole elements of 8 bytes.
void decode_quaternions(std::span<char> bytes);

}  // namespace unwrapd::asset::codec
