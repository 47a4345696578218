#pragma once
// The grids on which Draco keeps floats as whole numbers: coarse ones for positions, and for
// texture coordinates the one on which they lie already, so that they come out as they went in.

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "core/asset/gltf/gltf.hpp"

namespace unwrapd::asset::codec {

struct DracoGrid {
  std::array<float, 3> origin = {};
  float range = 1;
  int bits = 14;

  /// What Draco's readers make of a value, in the arithmetic of its encoder and decoder.
  [[nodiscard]] float rounded(float value, std::size_t component) const;
};

/// A grid for the positions of each mesh: one for all its primitives, so that none come apart. A
/// mesh with positions of another type than floats, or without extent, has none.
std::map<std::size_t, DracoGrid> position_grids(const Gltf& gltf, int bits);

/// The grid on which all values of a float accessor of two components lie, if 24 bits hold it.
std::optional<DracoGrid> exact_grid(const Gltf& gltf, std::size_t accessor);

}  // namespace unwrapd::asset::codec
