#pragma once
// What an atlas is worth, measured on the texture coordinates that were written and on nothing
// else: none of core's own measures is used.

#include <span>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::bench {

/// A triangle as written. chart: of the whole atlas, 0..
struct WrittenFace {
  std::array<Vec3, 3> position;
  CornerUv uv;
  std::array<Index, 3> vertex;  ///< one for each place and texture coordinates
  Index chart = 0;
};

/// The faces that have area in space, each once: a face that repeats another lies on it on purpose.
std::vector<WrittenFace> written_faces(std::span<const Surface> surfaces,
                                       std::span<const UnwrappedSurface> unwrapped);

struct WrittenAtlas {
  Index charts = 0;
  double angle = 2, area = 2;  ///< D_angle, D_area, under one scale for all charts
  double fill = 0;             ///< of the unit square
  Index flips = 0;
  Index mirrored = 0;                   ///< charts of negative area
  std::int64_t overlapping_texels = 0;  ///< texels whose middle lies in two faces
  double gap = 0;  ///< texels between two charts or to the border, at least; most_gap when more
};

/// texels: a side of the page for the overlaps; resolution: a side for the gap.
struct WrittenRules {
  int texels = 4096;
  int resolution = 1024;
  double most_gap = 4;
};
WrittenAtlas measure_written(std::span<const WrittenFace> faces, const WrittenRules& rules);

}  // namespace unwrapd::bench
