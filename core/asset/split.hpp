#pragma once
// Seams cut a pool of vertices: which of its vertices need copies, and what the faces then index.

#include <array>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "core/asset/gltf.hpp"

namespace unwrapd::asset {

/// The vertices of a pool after the cut: its own, then copies.
struct Split {
  std::vector<Index> copies;             ///< vertex n + k is a copy of copies[k]
  std::vector<std::array<float, 2>> uv;  ///< of each vertex, glTF's V pointing down
  std::map<std::size_t, std::vector<Index>>
      corners;                    ///< of each piece, as far as they are asked for
  std::set<std::size_t> changed;  ///< pieces whose faces have other corners now
};

/// Splits pools one after another; what it keeps between them is scratch.
class Splitter {
 public:
  Splitter(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped);

  /// pieces: those of the pool, each once. vertex_count: of the pool. all: the corners of every
  /// piece are wanted, not only of those that have changed.
  Split split(const std::vector<std::size_t>& pieces, std::size_t vertex_count, bool all);

 private:
  Index place_corner(const Piece& piece, Index corner, Split& split);
  void forget(const Piece& piece);

  const Gltf& gltf_;
  std::span<const UnwrappedSurface> unwrapped_;
  std::vector<std::vector<Index>> placed_;  ///< [surface][its vertex]: number in the pool, or -1
  std::vector<char> taken_;                 ///< [vertex of the pool]: has its UV
};

}  // namespace unwrapd::asset
