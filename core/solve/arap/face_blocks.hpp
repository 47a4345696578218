#pragma once
// The faces of a disk as the local step reads them: four side by side, and in blocks that reach few
// vertices. In the order of elimination, which leaves a region of the disk before it goes on, the
// faces around so many consecutive vertices reach about a fifth more: all that a block reads and
// adds up lies in the second cache, and what it adds to another's vertices is little.

#include <array>
#include <span>
#include <stop_token>
#include <vector>

#include "core/measure/rest_triangle.hpp"

namespace unwrapd::solve::arap {

inline constexpr std::size_t kFacesAbreast = 4;

/// Four faces side by side. Each triangle lies with corner 0 at the origin and corner 1 on the x
/// axis: [x^1 x^2]^-1 = [across shear; 0 up]. The last group of a block is filled up with copies of
/// its last face, of area 0.
struct FaceGroup {
  template <typename T>
  using Each = std::array<T, kFacesAbreast>;

  std::array<Each<Index>, 3> corner;  ///< as the block numbers vertices
  Each<double> across, shear, up, area;
};

/// Vertices go by ranks here. Those of a block are numbered: first its own, the ranks first ..
/// first + own - 1, then the others that its faces reach, as listed in FaceBlocks::beyond from
/// beyond_begin on.
struct FaceBlock {
  Index first, own;
  std::size_t beyond_begin, beyond_end;
  std::size_t group_begin, group_end;

  [[nodiscard]] std::size_t vertex_count() const {
    return static_cast<std::size_t>(own) + beyond_end - beyond_begin;
  }
};

/// A face is in the block that owns the lowest of its ranks.
struct FaceBlocks {
  std::vector<FaceBlock> all;
  std::vector<FaceGroup> groups;
  std::vector<Index> beyond;  ///< ranks

  static constexpr Index kOwn = 2048;  ///< vertices of a block: fixed, so no sum depends on threads
};

inline std::size_t bytes_of(const FaceBlocks& blocks) {
  return sizeof(FaceBlock) * blocks.all.size() + sizeof(FaceGroup) * blocks.groups.size() +
         sizeof(Index) * blocks.beyond.size();
}

/// rest: one a face; rank: one a vertex, a permutation. Throws Error{cancelled}.
FaceBlocks face_blocks(std::span<const measure::RestTriangle> rest, std::span<const Triangle> faces,
                       std::span<const Index> rank, const std::stop_token& stop = {});

}  // namespace unwrapd::solve::arap
