// A queue of neighbours orders their unions by a forecast: much border removed, little distortion
// added. The forecast is what was known of the parts when they were last tested. A union is tested
// when it reaches the top (lazy greedy, Minoux 1978), several at a time so that threads have work;
// the batches do not depend on the number of threads. Merging by normals alone stops far too early:
// only a map by ARAP shows whether a union can be flattened.
#include "core/segment/base/merge.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <queue>
#include <tuple>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/splitmix64.hpp"
#include "core/mesh/cross.hpp"
#include "core/pack/box.hpp"
#include "core/segment/base/labels.hpp"
#include "core/segment/base/region_pair.hpp"

namespace unwrapd::segment {
namespace {

constexpr std::size_t kBatch = 4;   // unions tried at once
constexpr double kWideShare = 0.2;  // what the wider region's share of border counts
constexpr double kLarge = 0.04;     // of the page: of a union whose shape matters
constexpr double kLast = 1e99;      // the key of unions that failed before

double area_within(const UvMap& hull) {
  double area = 0;
  for (std::size_t k = 2; k < hull.size(); ++k) {
    area += cross(hull[k - 1] - hull[0], hull[k] - hull[0]) / 2;
  }
  return area;
}

/// What is expected of the union of two neighbours.
struct Forecast {
  double rise = 0;  ///< excess that the union may add
  bool was_flawed = false;
  bool is_impossible = false;
};

struct Union {
  double key = 0;
  Index a = 0, b = 0;
  std::shared_ptr<Joined> tried = {};  ///< nothing: not yet

  bool operator>(const Union& other) const {
    return std::tie(key, a, b) > std::tie(other.key, other.a, other.b);
  }
};

class Merging {
 public:
  Merging(const MergeContext& context, const Joiner& joiner, Partition from,
          const MergeSettings& settings)
      : context_(context),
        joiner_(joiner),
        surface_(context.surface),
        settings_(settings),
        open_(std::move(from.open)),
        regions_(std::move(from.regions)) {
    alive_.assign(regions_.size(), 1);
    count_ = regions_.size();
    for (const MappedRegion& region : regions_) total_ += region.excess;
    measure_borders();
  }

  void run(Executor& executor) {
    for (Index a = 0; a < static_cast<Index>(regions_.size()); ++a)
      for (const auto& [b, unused] : borders_[a])
        if (a < b) propose(a, b, {});
    while (!queue_.empty() && count_ > static_cast<std::size_t>(settings_.enough)) {
      throw_if_cancelled(context_.stop);
      Union best = queue_.top();
      if (best.tried == nullptr) {
        try_batch(executor);
        continue;
      }
      queue_.pop();
      if (is_alive(best)) accept(best);
    }
  }

  [[nodiscard]] Partition take() {
    Partition left{{}, std::move(open_)};
    for (std::size_t k = 0; k < regions_.size(); ++k)
      if (alive_[k] != 0) left.regions.push_back(std::move(regions_[k]));
    return left;
  }

 private:
  void measure_borders() {
    std::vector<Index> owner(surface_.mesh.faces.size(), -1);
    for (std::size_t k = 0; k < regions_.size(); ++k)
      for (const Index t : regions_[k].faces) owner[t] = static_cast<Index>(k);
    borders_.resize(regions_.size());
    perimeter_.assign(regions_.size(), 0);
    for (Index h = 0; h < static_cast<Index>(surface_.halfedges.twin.size()); ++h) {
      const Index twin = surface_.halfedges.twin[h], own = owner[face_of(h)];
      const Index other = twin == kNoTwin ? -1 : owner[face_of(twin)];
      if (own < 0 || own == other) continue;
      if (settings_.only_kept && surface_.kept[h] == 0) continue;
      perimeter_[own] += surface_.seam_cost[h];
      if (other >= 0 && open_[h] == 0) borders_[own][other] += surface_.seam_cost[h];
    }
  }

  [[nodiscard]] bool is_alive(const Union& u) const { return alive_[u.a] != 0 && alive_[u.b] != 0; }

  /// Lower is better.
  [[nodiscard]] double key(Index a, Index b, double rise) const {
    const double border = borders_[a].at(b);
    const double narrow = std::min(perimeter_[a], perimeter_[b]);
    const double wide = std::max(perimeter_[a], perimeter_[b]);
    const double distortion_weight =
        settings_.budget > 0 ? settings_.distortion_weight * rise / settings_.budget : 0;
    const double worth = border / narrow + kWideShare * border / wide;
    return rounded(distortion_weight - worth * (1 + settings_.noise * drawn(a, b)));
  }

  /// A random number in [0, 1) for this pair under the seed.
  [[nodiscard]] double drawn(Index a, Index b) const {
    const auto pair = std::minmax(a, b);
    const std::uint64_t both =
        static_cast<std::uint64_t>(pair.first) << 32 | static_cast<std::uint64_t>(pair.second);
    const std::uint64_t seed = static_cast<std::uint64_t>(settings_.seed + 1) * kGoldenStep;
    return static_cast<double>(splitmix64(both + seed) >> 11) * 0x1p-53;
  }

  void propose(Index a, Index b, const Forecast& forecast) {
    if (std::max(a, b) < settings_.whole) return;
    if (forecast.is_impossible || !regions_[a].is_sound || !regions_[b].is_sound) return;
    const double forecast_key = forecast.was_flawed ? kLast : key(a, b, forecast.rise);
    queue_.push({forecast_key, std::min(a, b), std::max(a, b)});
  }

  /// Whether testing both at once may be for nothing, and dear: they have a large region in common,
  /// so that where one of them is made, the other no longer can be.
  [[nodiscard]] bool would_waste(const Union& u, const Union& v) const {
    for (const auto& [large, small] : {std::pair(u.a, u.b), std::pair(u.b, u.a)})
      if ((large == v.a || large == v.b) && is_small_beside(regions_[small], regions_[large]))
        return true;
    return false;
  }

  /// Tests the best unions that were not tested yet.
  void try_batch(Executor& executor) {
    std::vector<Union> batch;
    while (!queue_.empty() && batch.size() < kBatch && queue_.top().tried == nullptr) {
      const Union& next = queue_.top();
      if (is_alive(next)) {
        if (std::ranges::any_of(batch, [&](const Union& u) { return would_waste(u, next); })) break;
        batch.push_back(next);
      }
      queue_.pop();
    }
    executor.for_each_block(static_cast<int>(batch.size()), [&](int k) {
      Union& own = batch[static_cast<std::size_t>(k)];
      own.tried = std::make_shared<Joined>(joined(regions_[own.a], regions_[own.b]));
    });
    throw_if_cancelled(context_.stop);
    for (Union& both : batch) {
      if (context_.progress != nullptr)
        context_.progress->add(regions_[both.a].faces.size() + regions_[both.b].faces.size());
      judge(std::move(both));
    }
  }

  [[nodiscard]] Joined joined(const MappedRegion& a, const MappedRegion& b) const {
    TestRules trial{.stop = context_.stop, .memory = context_.failures};
    if (!settings_.anyhow) return joiner_.join(a, b, open_, settings_.cap, trial);
    trial.most_excess = std::max(settings_.cap * (a.area + b.area), (a.excess + b.excess).worst());
    return joiner_.force(a, b, open_, trial, settings_.anyhow);
  }

  /// Whether the shape of the region would leave too much of a page empty.
  [[nodiscard]] bool is_awkward(const Joined& joined) const {
    const MappedRegion& region = joined.region;
    if (settings_.least_fill <= 0 || region.area < kLarge * settings_.page_area) return false;
    std::vector<char> open = open_;
    for (const Index h : joined.slit) open[h] = 1;
    UvMap points;
    for (const auto& [from, to] : boundary_sides(surface_, open, region)) {
      points.push_back(from);
      points.push_back(to);
    }
    points = pack::convex_hull(std::move(points));
    const double side = pack::squarest_box(points).size.maxCoeff();
    return side * side * settings_.least_fill > settings_.page_area ||
           settings_.least_solid * area_within(points) > region.area;
  }

  void judge(Union both) {
    Forecast& known = known_[{both.a, both.b}];
    Joined& joined = *both.tried;
    if (joined.region.is_sound && is_awkward(joined)) joined.region.is_sound = false;
    const ExcessDistortion rise =
        joined.region.excess - regions_[both.a].excess - regions_[both.b].excess;
    known = {std::max(rise.worst(), 0.0), !joined.region.is_sound,
             joined.verdict == Verdict::impossible};
    if (!joined.region.is_sound) return;
    both.key = key(both.a, both.b, known.rise);
    queue_.push(std::move(both));
  }

  void accept(const Union& best) {
    const ExcessDistortion after =
        total_ + best.tried->region.excess - regions_[best.a].excess - regions_[best.b].excess;
    if (after.worst() > std::max(settings_.budget, total_.worst())) return;
    total_ = after;
    const auto joined = static_cast<Index>(regions_.size());
    double slit = 0;
    for (const Index h : best.tried->slit) {
      open_[h] = 1;
      slit += surface_.seam_cost[h];
    }
    perimeter_.push_back(perimeter_[best.a] + perimeter_[best.b] - 2 * borders_[best.a].at(best.b) +
                         slit);
    regions_.push_back(std::move(best.tried->region));
    alive_.push_back(1);
    borders_.push_back(joined_borders(best.a, best.b));
    for (const Index part : {best.a, best.b}) {
      alive_[part] = 0;
      regions_[part] = {};
    }
    --count_;
    for (const auto& [other, length] : borders_[joined]) meet(joined, other, length, best);
  }

  [[nodiscard]] std::map<Index, double> joined_borders(Index a, Index b) const {
    std::map<Index, double> borders;
    for (const Index part : {a, b})
      for (const auto& [other, length] : borders_[part])
        if (other != a && other != b) borders[other] += length;
    return borders;
  }

  /// Gives `other` its new neighbour, with the forecasts for the two parts.
  void meet(Index joined, Index other, double length, const Union& parts) {
    Forecast forecast;
    for (const Index part : {parts.a, parts.b}) {
      borders_[other].erase(part);
      const auto known = known_.find(std::minmax(part, other));
      if (known == known_.end()) continue;
      forecast.rise = std::max(forecast.rise, known->second.rise);
      forecast.was_flawed = forecast.was_flawed || known->second.was_flawed;
      forecast.is_impossible = forecast.is_impossible || known->second.is_impossible;
    }
    borders_[other][joined] = length;
    known_[std::minmax(joined, other)] = forecast;
    propose(joined, other, forecast);
  }

  const MergeContext& context_;
  const Joiner& joiner_;
  const SegmentationMesh& surface_;
  const MergeSettings& settings_;
  std::vector<char> open_;
  std::vector<MappedRegion> regions_;  ///< those that were merged are dead and empty
  std::vector<char> alive_;
  std::vector<std::map<Index, double>> borders_;  ///< lengths to each neighbour
  std::vector<double> perimeter_;
  std::map<std::pair<Index, Index>, Forecast> known_;
  std::priority_queue<Union, std::vector<Union>, std::greater<>> queue_;
  ExcessDistortion total_;
  std::size_t count_ = 0;
};

}  // namespace

Partition merge_regions(const MergeContext& context, const Joiner& joiner, Partition from,
                        const MergeSettings& settings, Executor& executor) {
  Merging merging(context, joiner, std::move(from), settings);
  merging.run(executor);
  return merging.take();
}

std::vector<Index> owners(const SegmentationMesh& surface, const Partition& partition) {
  std::vector<Index> owner(surface.mesh.faces.size());
  for (std::size_t k = 0; k < partition.regions.size(); ++k)
    for (const Index t : partition.regions[k].faces) owner[t] = static_cast<Index>(k);
  return owner;
}

}  // namespace unwrapd::segment
