#pragma once
// The judge of a set of faces: a cheap ARAP map of it, and what that map is worth.

#include <stop_token>
#include <vector>

#include "core/measure/distortion.hpp"
#include "core/segment/base/segmentation_mesh.hpp"

namespace unwrapd::segment {

/// Area-weighted distortion above the ideal, in units of the surface: area * (D - 2).
struct ExcessDistortion {
  double angle = 0;
  double area = 0;

  [[nodiscard]] double worst() const { return angle > area ? angle : area; }
  ExcessDistortion& operator+=(const ExcessDistortion& other) {
    angle += other.angle;
    area += other.area;
    return *this;
  }
  friend ExcessDistortion operator+(ExcessDistortion a, const ExcessDistortion& b) {
    return a += b;
  }
  friend ExcessDistortion operator-(const ExcessDistortion& a, const ExcessDistortion& b) {
    return {a.angle - b.angle, a.area - b.area};
  }
};

/// For UV area = 3D area.
ExcessDistortion excess_of(const measure::DistortionSums& sums);

enum class Verdict {
  sound,       ///< the map has no flip and no overlap, by exact tests
  distorted,   ///< above the excess that was allowed
  flawed,      ///< flips or overlaps
  impossible,  ///< the faces are closed, in pieces, or have a handle
};

/// A set of faces that is glued wherever two of them are twins, except across `open` half-edges.
struct Region {
  std::vector<Index> faces;
  std::vector<CornerUv> uv;  ///< one a face: its map so far, or a seed for it
  std::size_t mapped = 0;    ///< this many faces at the front have a sound map together, which
                             ///< stays as it is away from the others
  bool is_forced = false;    ///< joined only to keep to a number of charts; its map may overlap
};

class FailedTrials;

struct TestRules {
  int iterations = 4;
  double most_excess = 0;  ///< worst() of a sound map is at most this
  std::stop_token stop = {};
  FailedTrials* memory = nullptr;  ///< of failures, that need no second trial; null: none
};

struct TestResult {
  Verdict verdict = Verdict::impossible;
  ExcessDistortion excess;
};

/// A few iterations of ARAP from the rotations of region.uv, which need not hold together. Where a
/// part is `mapped`, only the other faces and a rim around them are mapped (ADR 0080). Where the
/// map is sound, region.uv becomes it, with UV area = 3D area; else it is of no use. open: one a
/// half-edge of the surface, 1: not glued; empty: none. A stop request ends it early, with any
/// verdict.
TestResult test_parameterization(const SegmentationMesh& surface, std::span<const char> open,
                                 const TestRules& rules, Region& region);

}  // namespace unwrapd::segment
