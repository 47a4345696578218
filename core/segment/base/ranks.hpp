#pragma once
// Where in a list each face of a surface stands, without a walk over the surface for every list.

#include <span>
#include <vector>

#include "core/mesh/halfedges.hpp"

namespace unwrapd::segment {

/// Kept per thread and wiped after use: what it costs is the list, not the surface.
class Ranks {
 public:
  /// faces, each once, below face_count, must outlive it.
  Ranks(std::size_t face_count, std::span<const Index> faces);
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  /// The place of face t in the list; kNoTwin: it is not there.
  Index operator[](Index t) const { return rank_[static_cast<std::size_t>(t)]; }

 private:
  std::span<const Index> faces_;
  std::vector<Index> rank_;
};

}  // namespace unwrapd::segment
