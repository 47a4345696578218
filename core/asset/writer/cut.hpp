#pragma once
// Splits the vertices of a pool at seams: copies for texture coordinates first, then for tangents.

#include <span>
#include <vector>

#include "core/asset/gltf/gltf.hpp"
#include "core/asset/gltf/materials.hpp"
#include "core/asset/writer/split.hpp"
#include "core/asset/writer/tangent_space.hpp"

namespace unwrapd::asset::writer {

/// The primitives that share a pool's vertices, and their pieces in order of first use.
struct Pool {
  std::vector<std::size_t> primitives;
  std::vector<std::size_t> pieces;
};

/// The pools that have primitives to unwrap.
std::vector<Pool> pools_of(const Gltf& gltf);

struct Cut {
  Split split;
  std::vector<Tangent> tangents;  ///< [vertex]; set if a primitive of the pool needs new tangents
};

/// Cuts pools one after another.
class Cutter {
 public:
  Cutter(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped)
      : gltf_(gltf), materials_(gltf), splitter_(gltf, unwrapped) {}

  /// Throws Error{cancelled}.
  Cut cut(const Pool& pool);

 private:
  const Gltf& gltf_;
  Materials materials_;
  Splitter splitter_;
};

}  // namespace unwrapd::asset::writer
