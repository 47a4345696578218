#pragma once
// Splits a pool of vertices at seams: which vertices need copies, and the new indices of faces.

#include <array>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "core/asset/gltf/gltf.hpp"

namespace unwrapd::asset::writer {

/// The vertices of a pool after the cut: its own, then copies.
struct Split {
  std::vector<Index> copies;                          ///< vertex n + k is a copy of copies[k]
  std::vector<std::array<float, 2>> uv;               ///< of each vertex, glTF's V pointing down
  std::map<std::size_t, std::vector<Index>> corners;  ///< [piece]: its corners, if requested
  std::set<std::size_t> changed;                      ///< pieces whose faces have new corners
};

/// Splits pools one after another; its members are reused.
class Splitter {
 public:
  Splitter(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped);

  /// pieces: those of the pool, each once. vertex_count: of the pool. all: return the corners of
  /// every piece, not only of changed ones.
  Split split(const std::vector<std::size_t>& pieces, std::size_t vertex_count, bool all);

 private:
  Index place_corner(const Piece& piece, Index corner, Split& split);
  void forget(const Piece& piece);

  const Gltf& gltf_;
  std::span<const UnwrappedSurface> unwrapped_;
  std::vector<std::vector<Index>> placed_;  ///< [surface][its vertex]: index in the pool, or -1
  std::vector<char> taken_;                 ///< [vertex of the pool]: whether it has its UV
};

}  // namespace unwrapd::asset::writer
