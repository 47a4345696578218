#pragma once
// Two neighbouring regions tried as one.

#include <vector>

#include "core/segment/test_parameterization.hpp"

namespace unwrapd::segment {

/// A region with the map that it has so far.
struct MappedRegion {
  Region region;
  ExcessDistortion excess;  ///< of that map
  double area = 0;          ///< of the surface's 1
  bool is_sound = false;    ///< its map is; what is not sound merges with nothing

  [[nodiscard]] double mean_excess() const { return excess.worst() / area; }
};

struct Joined {
  MappedRegion patch;  ///< of both; sound where verdict says so; no faces where none was tried
  Verdict verdict = Verdict::impossible;
  std::vector<Index> slit;  ///< half-edges of the common border that must stay open, both sides
};

/// The faces and maps of both, b turned and moved to where its half-edges `border` lie in a.
Region beside(const SegmentationMesh& surface, const Region& a, const Region& b,
              std::span<const Index> border);

/// What joining regions needs of the surface, worked out once.
class Joiner {
 public:
  /// surface must outlive the joiner.
  explicit Joiner(const SegmentationMesh& surface);

  /// b laid beside a, turned and moved as their common border asks, then mapped together, unless
  /// they miss each other by too much there, which is flawed. Where that has no sound map, only the
  /// longest stretch of the border is glued: stretches end at vertices that are far from flat. cap:
  /// most excess over area, where joining adds some. open: one a half-edge of the surface, 1: not
  /// glued. trial: but for the excess. A stop request ends it early.
  [[nodiscard]] Joined join(const MappedRegion& a, const MappedRegion& b,
                            std::span<const char> open, double cap, const TestRules& trial) const;

 private:
  [[nodiscard]] double length_of(std::span<const Index> border) const;
  [[nodiscard]] std::vector<Index> slit_of(std::span<const Index> border) const;

  const SegmentationMesh& surface_;
  std::vector<char> is_flat_;  ///< one a vertex
};

}  // namespace unwrapd::segment
