#pragma once
// Two neighbouring regions, and one laid beside the other as their common border asks.

#include <span>
#include <vector>

#include "core/segment/base/ranks.hpp"
#include "core/segment/base/test_parameterization.hpp"

namespace unwrapd::segment {

/// Where b lies beside a.
struct Placement {
  Region both;      ///< the faces and maps of a, then those of b, turned and moved
  double miss = 0;  ///< root mean square of how far the ends of the border are from each other
};

class RegionPair {
 public:
  /// All must outlive the pair.
  RegionPair(const SegmentationMesh& surface, const Region& a, const Region& b);

  [[nodiscard]] const Region& a() const { return a_; }
  [[nodiscard]] const Region& b() const { return b_; }

  /// The half-edges of b across which a lies. open: one a half-edge of the surface, 1: not glued.
  [[nodiscard]] std::vector<Index> border(std::span<const char> open) const;

  /// By the motion that brings these half-edges of b nearest to where they lie in a.
  [[nodiscard]] Placement place(std::span<const Index> border) const;

  /// Placement::miss of place() alone.
  [[nodiscard]] double miss(std::span<const Index> border) const;

  /// The share of b's area that lies on the map of a there, by some of its faces. open: as above.
  [[nodiscard]] double covered(const Placement& placement, std::span<const char> open) const;

 private:
  [[nodiscard]] std::vector<std::array<Vec2, 2>> ends(std::span<const Index> border) const;

  const SegmentationMesh& surface_;
  const Region &a_, &b_;
  Ranks in_a_, in_b_;
};

/// RegionPair::place() alone.
Region beside(const SegmentationMesh& surface, const Region& a, const Region& b,
              std::span<const Index> border);

/// {start, end} of the sides at the boundary of a region's map, in any order. open: as above.
std::vector<std::array<Vec2, 2>> boundary_sides(const SegmentationMesh& surface,
                                                std::span<const char> open, const Region& region);

}  // namespace unwrapd::segment
