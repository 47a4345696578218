#pragma once
// Two neighbouring regions tried as one.

#include <functional>
#include <span>
#include <vector>

#include "core/segment/base/test_parameterization.hpp"

namespace unwrapd::segment {

/// A region with the map that it has so far.
struct MappedRegion : Region {
  ExcessDistortion excess = {};  ///< of that map
  double area = 0;               ///< of the surface's 1
  double area_added = 0;         ///< of it, since all of it was last mapped
  bool is_sound = false;         ///< its map is, or it is forced; else no union with it is tried

  [[nodiscard]] double mean_excess() const { return excess.worst() / area; }
};

/// The excess of all regions.
ExcessDistortion total_excess(std::span<const MappedRegion> regions);

struct Joined {
  MappedRegion region;  ///< of both; sound where verdict says so; no faces where none was tried
  Verdict verdict = Verdict::impossible;
  std::vector<Index> slit;  ///< half-edges of the common border that must stay open, both sides
};

/// Whether a is large and b has a fraction of its faces, so that mapping all of a anew for b costs
/// more than it tells (ADR 0080).
bool is_small_beside(const Region& b, const Region& a);

/// Both as one region that is not mapped yet. laid: b beside a. Where b is small and little was
/// added to a since all of it was mapped, the map of a stays (Region::mapped).
MappedRegion unite(const MappedRegion& a, const MappedRegion& b, Region laid);

/// Maps a region at any distortion. `impossible`: the region is no disk. `flawed`: the map has
/// flips or overlaps, and the excess is an estimate. open: one a half-edge. Does not throw; a stop
/// request ends it early, with any verdict.
using MapAnyhow = std::function<TestResult(std::span<const char> open, Region& region)>;

/// What joining regions needs of the surface, worked out once.
class Joiner {
 public:
  /// surface must outlive the joiner.
  explicit Joiner(const SegmentationMesh& surface);

  /// b laid beside a, or a beside b where a is small beside it, turned and moved as their common
  /// border asks, then both mapped together, unless that is hopeless, which is flawed.
  /// Where that has no sound map, only the longest stretch of the border is glued: stretches end at
  /// vertices that are far from flat. cap: most excess over area, where joining adds some. open:
  /// one a half-edge of the surface, 1: not glued. trial: but for the excess. A stop request ends
  /// it early.
  [[nodiscard]] Joined join(const MappedRegion& a, const MappedRegion& b,
                            std::span<const char> open, double cap, const TestRules& trial) const;

  /// Joins both although join() found no sound map. Tries all of their border from another start,
  /// then parts of the border. If no map is sound, the part is glued at which least of b lies on a.
  [[nodiscard]] Joined force(const MappedRegion& a, const MappedRegion& b,
                             std::span<const char> open, const TestRules& trial,
                             const MapAnyhow& map) const;

 private:
  [[nodiscard]] double length_of(std::span<const Index> border) const;
  [[nodiscard]] std::vector<Index> slit_of(std::span<const Index> border) const;
  [[nodiscard]] std::vector<Index> both_sides(std::span<const Index> border) const;
  [[nodiscard]] std::vector<Index> longest_stretch(std::span<const Index> border) const;

  const SegmentationMesh& surface_;
  std::vector<char> is_flat_;  ///< one a vertex
};

}  // namespace unwrapd::segment
