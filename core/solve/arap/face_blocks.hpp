#pragma once
// The faces of a disk in the layout of the local step: groups of four, in blocks that reach few
// vertices. The order of elimination finishes a region of the disk before it goes on, so that the
// faces around consecutive vertices reach only about a fifth more vertices. A block's data fits
// into the second-level cache, and a block adds little to the vertices of others.

#include <array>
#include <span>
#include <stop_token>
#include <vector>

#include "core/measure/rest_triangle.hpp"

namespace unwrapd::solve::arap {

inline constexpr std::size_t kFacesAbreast = 4;

/// Four faces, one in each lane. Each triangle has corner 0 at the origin and corner 1 on the x
/// axis: [x^1 x^2]^-1 = [across shear; 0 up]. The last group of a block is padded with copies of
/// its last face, of area 0.
struct FaceGroup {
  template <typename T>
  using Each = std::array<T, kFacesAbreast>;

  std::array<Each<Index>, 3> corner;  ///< as the block numbers vertices
  Each<double> across, shear, up, area;
};

/// Vertices are given by ranks. A block numbers first its own vertices, the ranks first .. first +
/// own - 1, then the others that its faces reach, listed in FaceBlocks::beyond from beyond_begin
/// on.
struct FaceBlock {
  Index first, own;
  std::size_t beyond_begin, beyond_end;
  std::size_t group_begin, group_end;

  [[nodiscard]] std::size_t vertex_count() const {
    return static_cast<std::size_t>(own) + beyond_end - beyond_begin;
  }
};

/// Each face belongs to the block that owns the lowest of its ranks.
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
