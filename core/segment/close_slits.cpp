// A union that fails is glued along one stretch of its border and slit along the rest (join.hpp).
// That is decided once, while the region is still small; what it became may lie flat without. How
// far a slit can be glued is found by bisection: the more of it is glued, the more the map is bent.
#include "core/segment/close_slits.hpp"

#include <algorithm>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/mesh/edges.hpp"
#include "core/segment/remap.hpp"

namespace unwrapd::segment {
namespace {

/// Half-edges of a slit in a row, one of each edge, from one end to the other.
using Slit = std::vector<Index>;

class Gluing {
 public:
  Gluing(const MergeContext& context, const MergeSettings& settings, Partition& partition)
      : context_(context),
        surface_(context.surface),
        settings_(settings),
        partition_(partition),
        owner_(surface_.mesh.faces.size()) {
    for (std::size_t k = 0; k < partition.patches.size(); ++k) {
      total_ += partition.patches[k].excess;
      for (const Index t : partition.patches[k].region.faces) owner_[t] = static_cast<Index>(k);
    }
    degree_.assign(surface_.mesh.positions.size(), 0);
    for (Index h = 0; h < count(); ++h) {
      if (!is_seam(h) || (twin(h) != kNoTwin && twin(h) < h)) continue;
      ++degree_[start(h)];
      ++degree_[end(h)];
    }
  }

  void run() {
    for (Slit& slit : find()) {
      throw_if_cancelled(context_.stop);
      const bool has_tip = degree_[end(slit.back())] == 1 || degree_[start(slit.front())] == 1;
      if (degree_[start(slit.front())] != 1) {  // the tip first
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
  [[nodiscard]] Index count() const { return static_cast<Index>(partition_.open.size()); }
  [[nodiscard]] Index twin(Index h) const { return surface_.halfedges.twin[h]; }
  [[nodiscard]] Index start(Index h) const { return start_of(surface_.mesh.faces, h); }
  [[nodiscard]] Index end(Index h) const { return end_of(surface_.mesh.faces, h); }

  [[nodiscard]] bool is_slit(Index h) const {
    return partition_.open[h] != 0 && twin(h) != kNoTwin &&
           owner_[face_of(h)] == owner_[face_of(twin(h))];
  }
  [[nodiscard]] bool is_seam(Index h) const {
    return twin(h) == kNoTwin || partition_.open[h] != 0 ||
           owner_[face_of(h)] != owner_[face_of(twin(h))];
  }

  /// The slit that goes on from h where just two seams meet; kNoTwin else.
  [[nodiscard]] Index next(Index h) const {
    if (degree_[end(h)] != 2) return kNoTwin;
    Index g = next_halfedge(h);
    while (!is_seam(g)) g = next_halfedge(twin(g));
    return is_slit(g) ? g : kNoTwin;
  }

  [[nodiscard]] std::vector<Slit> find() const {
    std::vector<Slit> slits;
    std::vector<char> taken(partition_.open.size(), 0);
    for (Index first = 0; first < count(); ++first) {
      if (!is_slit(first) || degree_[start(first)] == 2 || taken[first] != 0) continue;
      Slit slit;
      for (Index h = first; h != kNoTwin; h = next(h)) {
        taken[h] = taken[twin(h)] = 1;
        slit.push_back(h);
      }
      slits.push_back(std::move(slit));
    }
    return slits;
  }

  /// Whether the region keeps a sound map with these glued; then they are.
  bool glue(std::span<const Index> edges) {
    MappedRegion& old = partition_.patches[owner_[face_of(edges.front())]];
    const auto set_open = [&](char is_open) {
      for (const Index h : edges) partition_.open[h] = partition_.open[twin(h)] = is_open;
    };
    set_open(0);
    MappedRegion now = old;
    if (!remap(context_, settings_, partition_.open, old.excess, now, total_)) {
      set_open(1);
      return false;
    }
    old = std::move(now);
    return true;
  }

  const MergeContext& context_;
  const SegmentationMesh& surface_;
  const MergeSettings& settings_;
  Partition& partition_;
  std::vector<Index> owner_;  ///< one a face
  std::vector<int> degree_;   ///< seams that meet in a vertex
  ExcessDistortion total_;
};

}  // namespace

void close_slits(const MergeContext& context, const MergeSettings& settings, Partition& partition) {
  Gluing(context, settings, partition).run();
}

}  // namespace unwrapd::segment
