// A union that fails is glued along one stretch of its border and slit along the rest (join.hpp).
// That is decided once, while the region is still small; what it became may lie flat without. How
// far a slit can be glued is found by bisection: the more of it is glued, the more the map is bent.
// What is bent for little stays open: at the corners of a thin box, the sides would be sheared.
#include "core/segment/search/close_slits.hpp"

#include <algorithm>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/segment/search/remap.hpp"
#include "core/segment/search/seam_graph.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr double kLeastGain = 6;  // of length, for the excess that it costs (ADR 0083)

class Gluing {
 public:
  Gluing(const MergeContext& context, const MergeSettings& settings, Partition& partition)
      : context_(context),
        surface_(context.surface),
        settings_(settings),
        partition_(partition),
        seams_(surface_, partition) {
    for (const MappedRegion& region : partition.regions) total_ += region.excess;
  }

  void run() {
    for (Chain& slit : seams_.rows()) {
      throw_if_cancelled(context_.stop);
      if (!seams_.is_slit(slit.front())) continue;
      const bool starts_at_tip = seams_.degree(seams_.start(slit.front())) == 1;
      const bool has_tip = starts_at_tip || seams_.degree(seams_.end(slit.back())) == 1;
      if (!starts_at_tip) {  // the tip first
        std::ranges::reverse(slit);
        for (Index& h : slit) h = twin(h);
      }
      std::size_t glued = 0, most = slit.size();
      if (glue({slit.data(), most})) continue;
      while (has_tip && glued + 1 < most) {
        const std::size_t half = (glued + most) / 2;
        (glue({slit.data() + glued, half - glued}) ? glued : most) = half;
      }
    }
  }

 private:
  [[nodiscard]] Index twin(Index h) const { return surface_.halfedges.twin[h]; }

  [[nodiscard]] double seam_of(std::span<const Index> edges) const {
    double seam = 0;
    for (const Index h : edges) seam += surface_.seam_cost[h];
    return seam;
  }

  /// Whether the region keeps a sound map with these glued, and they are worth it; then they are.
  bool glue(std::span<const Index> edges) {
    MappedRegion& old = partition_.regions[seams_.owner(edges.front())];
    const auto set_open = [&](char is_open) {
      for (const Index h : edges) partition_.open[h] = partition_.open[twin(h)] = is_open;
    };
    set_open(0);
    MappedRegion now = old;
    ExcessDistortion total = total_;
    if (!remap(context_, settings_, partition_.open, old.excess, now, total) ||
        seam_of(edges) < kLeastGain * (now.excess - old.excess).worst()) {
      set_open(1);
      return false;
    }
    total_ = total;
    old = std::move(now);
    return true;
  }

  const MergeContext& context_;
  const SegmentationMesh& surface_;
  const MergeSettings& settings_;
  Partition& partition_;
  SeamGraph seams_;  ///< as they were
  ExcessDistortion total_;
};

}  // namespace

void close_slits(const MergeContext& context, const MergeSettings& settings, Partition& partition) {
  Gluing(context, settings, partition).run();
}

}  // namespace unwrapd::segment::search
