#pragma once
// Merges vertices at one position. Only topology uses this: the asset keeps its vertices.

#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// For each position, the number of the first vertex at exactly that position (-0 equals 0).
/// Positions are finite. Linear in the usual case, n log n in the worst.
std::vector<Index> weld(std::span<const Vec3> positions, const std::stop_token& stop = {});

/// The faces with every vertex replaced by `of[vertex]`.
std::vector<Triangle> renumber(std::span<const Triangle> faces, std::span<const Index> of);

}  // namespace unwrapd
