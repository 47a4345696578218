#pragma once
// What the seams make of a pool of vertices: the copies that texture coordinates ask for, then
// those that tangents do.

#include <span>
#include <vector>

#include "core/asset/gltf.hpp"
#include "core/asset/materials.hpp"
#include "core/asset/split.hpp"
#include "core/asset/tangent_space.hpp"

namespace unwrapd::asset {

/// The primitives that share a pool's vertices, and which pieces are theirs, in order of first use.
struct Pool {
  std::vector<std::size_t> primitives;
  std::vector<std::size_t> pieces;
};

/// Those that have primitives to unwrap.
std::vector<Pool> pools_of(const Gltf& gltf);

struct Cut {
  Split split;
  std::vector<Tangent> tangents;  ///< [vertex], where a primitive of the pool loses its own
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

}  // namespace unwrapd::asset
