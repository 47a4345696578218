// Regions with their images, joined so that the seams stay symmetric: a region with its own image
// across the plane, and a pair of images, both at once, to a region that is its own image.
#include "core/segment/join_symmetrically.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/measure/distortion.hpp"
#include "core/mesh/edges.hpp"
#include "core/segment/base/merge.hpp"
#include "core/segment/search/over_segment.hpp"
#include "core/segment/search/partition_cost.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kNoLimit = 1e6;

class SymmetricPartition {
 public:
  SymmetricPartition(const SegmentationMesh& surface, const Mirror& mirror, double excess,
                     const std::stop_token& stop)
      : surface_(surface),
        mirror_(mirror),
        stop_(stop),
        budget_(kMarginOfExcess * excess),
        joiner_(surface),
        open_(surface.length.size(), 0) {}

  /// Adds the regions of a part in front, each followed by a place for its image.
  void add(const FrontRegions& front) {
    const auto& [part, segments, area] = front;
    for (std::size_t h = 0; h < segments.open.size(); ++h)
      if (segments.open[h] != 0) open(3 * part.face[h / 3] + static_cast<Index>(h % 3));
    for (const Region& region : segments.regions) {
      regions_.push_back(sound(in_component(region, part, std::sqrt(area))));
      regions_.emplace_back();
    }
  }

  /// The regions of both sides, joined; nothing where an image is no disk, or distorted beyond the
  /// bound, which a mesh that is not quite symmetric may cause.
  std::optional<Segments> joined() && {
    reflect();
    if (!are_disks_) return std::nullopt;
    join_across();
    if (!keeps_bound()) return std::nullopt;
    return segments();
  }

 private:
  /// Gives each region its image.
  void reflect() {
    std::vector<Index> region(surface_.rest.size(), -1);
    std::vector<const CornerUv*> map(surface_.rest.size());
    for (std::size_t k = 0; k < regions_.size(); k += 2)
      for (std::size_t i = 0; i < regions_[k].faces.size(); ++i) {
        const Index t = regions_[k].faces[i];
        region[t] = static_cast<Index>(k);
        map[t] = &regions_[k].uv[i];
      }
    const std::vector<Index> sources = joined_sources(region);
    for (Index t = 0; t < surface_.face_count(); ++t)
      if (const Index source = sources[t]; source >= 0) {
        Region& image = regions_[region[source] + 1];
        image.is_forced = regions_[region[source]].is_forced;
        image.faces.push_back(t);
        image.uv.push_back(reflected_map(mirror_, surface_.mesh, {source, t}, *map[source]));
      }
    for (std::size_t k = 1; k < regions_.size(); k += 2)
      regions_[k] = tested(std::move(regions_[k]));
  }

  /// Joins regions with their images, then these with pairs of images and with each other. Regions
  /// of most common border come first.
  void join_across() {
    for (const MappedRegion& region : regions_) total_ += region.excess;
    is_whole_.assign(regions_.size(), 0);
    join_in_order(pairs_across(), [this](Index a, Index b) { join_two(a, b); });
    for (bool is_new = true; is_new;) {
      const std::ptrdiff_t before = count();
      join_in_order(pairs_at_whole(), [this](Index whole, Index a) { join_pair(whole, a); });
      join_in_order(pairs_of_whole(), [this](Index a, Index b) { join_two(a, b); });
      is_new = count() < before;
    }
  }

  [[nodiscard]] std::ptrdiff_t count() const {
    return std::ranges::count_if(regions_, [](const auto& own) { return !own.faces.empty(); });
  }

  /// Of all regions, and of each.
  [[nodiscard]] bool keeps_bound() const {
    const double most = budget_ / kMarginOfExcess, most_of_one = kMostOfOneRegion * most;
    return total_excess(regions_).worst() <= most && std::ranges::all_of(regions_, [&](auto& own) {
             return own.excess.worst() <= most_of_one * own.area;
           });
  }

  Segments segments() {
    std::erase_if(regions_, [](const MappedRegion& own) { return own.faces.empty(); });
    const Partition partition{std::move(regions_), std::move(open_)};
    Segments segments{.regions = {},
                      .open = partition.open,
                      .excess = total_excess(partition.regions),
                      .seam_length = search::seam_length(surface_, partition)};
    for (const MappedRegion& own : partition.regions) segments.regions.push_back(own);
    return segments;
  }

  using Borders = std::map<std::pair<Index, Index>, double>;

  void open(Index h) {
    open_[h] = 1;
    if (mirror_.halfedge[h] >= 0) open_[mirror_.halfedge[h]] = 1;
  }

  static Region in_component(const Region& of_part, const charts::ChartPart& part, double scale) {
    Region region = of_part;
    for (Index& t : region.faces) t = part.face[t];
    for (CornerUv& corners : region.uv)
      for (Vec2& u : corners) u *= scale;
    return region;
  }

  /// The faces in front from which faces behind have their region and map. One that lies apart from
  /// its region, because diagonals differ there, takes that of a neighbour.
  [[nodiscard]] std::vector<Index> joined_sources(const std::vector<Index>& region) const {
    std::vector<Index> sources = mirror_.source;
    for (Index t = 0; t < surface_.face_count(); ++t) {
      if (sources[t] < 0) continue;
      Index other = -1;
      bool is_apart = true;
      for (Index h = 3 * t; h < 3 * t + 3; ++h) {
        const Index twin = surface_.halfedges.twin[h];
        const Index across = twin == kNoTwin ? -1 : sources[face_of(twin)];
        if (across < 0) continue;
        other = across;
        is_apart = is_apart && region[across] != region[sources[t]];
      }
      if (is_apart && other >= 0) sources[t] = other;
    }
    return sources;
  }

  /// A region with the map that segmentation gave it.
  [[nodiscard]] MappedRegion sound(Region region) const {
    MappedRegion own{std::move(region)};
    measure::DistortionSums sums;
    const std::array<Triangle, 1> corners{{{0, 1, 2}}};
    for (std::size_t k = 0; k < own.faces.size(); ++k) {
      const Index t = own.faces[k];
      own.area += surface_.area(t);
      sums += measure::distortion_sums(std::span(&surface_.rest[t], 1), corners, own.uv[k]);
    }
    own.excess = excess_of(sums);
    own.is_sound = true;
    return own;
  }

  /// A region whose map may need mending. Without a sound one it stays as it is and alone.
  MappedRegion tested(Region region) {
    Region mapped = region;
    const TestRules rules{.most_excess = kNoLimit, .stop = stop_};
    const Verdict verdict = test_parameterization(surface_, open_, rules, mapped).verdict;
    if (verdict == Verdict::impossible) are_disks_ = false;
    MappedRegion own = sound(verdict == Verdict::sound ? std::move(mapped) : std::move(region));
    own.is_sound = verdict == Verdict::sound;
    return own;
  }

  /// The lengths of common borders of regions, lower index first.
  [[nodiscard]] Borders borders() const {
    const std::vector<Index> owner = owners(surface_, {regions_, {}});
    Borders lengths;
    for (Index h = 0; h < static_cast<Index>(open_.size()); ++h) {
      const Index twin = surface_.halfedges.twin[h];
      if (twin == kNoTwin || open_[h] != 0) continue;
      const Index a = owner[face_of(h)], b = owner[face_of(twin)];
      if (a < b) lengths[{a, b}] += surface_.length[h];
    }
    return lengths;
  }

  /// Regions and their images are neighbours in the list until they are joined.
  [[nodiscard]] Borders pairs_across() const {
    return borders_if([](Index a, Index b) { return a % 2 == 0 && b == a + 1; });
  }

  /// {a region that is its own image, the first of a pair that it touches}
  [[nodiscard]] Borders pairs_at_whole() const {
    Borders pairs;
    for (const auto& [both, length] : borders()) {
      const auto [a, b] = both;
      if (is_whole_[a] == is_whole_[b]) continue;
      const Index whole = is_whole_[a] != 0 ? a : b, other = is_whole_[a] != 0 ? b : a;
      pairs[{whole, other - other % 2}] += length;
    }
    return pairs;
  }

  /// Neighbours that are their own images.
  [[nodiscard]] Borders pairs_of_whole() const {
    return borders_if([this](Index a, Index b) { return is_whole_[a] != 0 && is_whole_[b] != 0; });
  }

  template <class Test>
  [[nodiscard]] Borders borders_if(Test test) const {
    Borders pairs = borders();
    std::erase_if(pairs,
                  [&](const auto& entry) { return !test(entry.first.first, entry.first.second); });
    return pairs;
  }

  template <class Join>
  void join_in_order(const Borders& pairs, Join join) {
    std::vector<std::pair<double, std::pair<Index, Index>>> order;
    for (const auto& [pair, length] : pairs) order.emplace_back(-std::round(length * 1e6), pair);
    std::ranges::sort(order);
    for (const auto& [length, pair] : order) {
      throw_if_cancelled(stop_);
      if (!regions_[pair.first].faces.empty() && !regions_[pair.second].faces.empty())
        join(pair.first, pair.second);
    }
  }

  [[nodiscard]] Joined join(const MappedRegion& a, const MappedRegion& b) const {
    return joiner_.join(a, b, open_, kMostOfOneRegion * budget_, {.stop = stop_});
  }

  /// Whether the slits are their own image, and the bound holds with this excess of the parts more.
  [[nodiscard]] bool is_allowed(const std::vector<Index>& slit,
                                const ExcessDistortion& more) const {
    const bool is_symmetric = std::ranges::all_of(slit, [&](Index h) {
      const Index image = mirror_.halfedge[h];
      return image < 0 || std::ranges::find(slit, image) != slit.end();
    });
    return is_symmetric && (total_ + more).worst() <= std::max(budget_, total_.worst());
  }

  void replace(Index by, MappedRegion joined, const std::vector<Index>& slit,
               const ExcessDistortion& more) {
    regions_[by] = std::move(joined);
    is_whole_[by] = 1;
    total_ += more;
    for (const Index h : slit) open_[h] = 1;
  }

  /// A region with its image, or two that are their own images.
  void join_two(Index a, Index b) {
    Joined both = join(regions_[a], regions_[b]);
    if (!both.region.is_sound) return;
    const ExcessDistortion more = both.region.excess - regions_[a].excess - regions_[b].excess;
    if (!is_allowed(both.slit, more)) return;
    regions_[b] = {};
    replace(a, std::move(both.region), both.slit, more);
  }

  void join_pair(Index whole, Index a) {
    const Index b = a + 1;
    const Joined first = join(regions_[whole], regions_[a]);
    if (!first.region.is_sound) return;
    Joined all = join(first.region, regions_[b]);
    if (!all.region.is_sound) return;
    const ExcessDistortion more =
        all.region.excess - regions_[whole].excess - regions_[a].excess - regions_[b].excess;
    std::vector<Index> slit = first.slit;
    slit.insert(slit.end(), all.slit.begin(), all.slit.end());
    if (!is_allowed(slit, more)) return;
    regions_[a] = regions_[b] = {};
    replace(whole, std::move(all.region), slit, more);
  }

  const SegmentationMesh& surface_;
  const Mirror& mirror_;
  const std::stop_token& stop_;
  const double budget_;
  const Joiner joiner_;
  std::vector<char> open_;
  std::vector<MappedRegion> regions_;  // 2k and 2k + 1: images; joined ones take the lower place
  std::vector<char> is_whole_;         // 1: it is its own image
  ExcessDistortion total_;
  bool are_disks_ = true;
};

}  // namespace

std::optional<Segments> join_symmetrically(const SegmentationMesh& surface, const Mirror& mirror,
                                           std::span<const FrontRegions> front, double excess,
                                           const std::stop_token& stop) {
  SymmetricPartition partition(surface, mirror, excess, stop);
  for (const FrontRegions& own : front) partition.add(own);
  return std::move(partition).joined();
}

}  // namespace unwrapd::segment
