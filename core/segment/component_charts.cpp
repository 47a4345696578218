#include "core/segment/component_charts.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "core/measure/rest_triangle.hpp"
#include "core/segment/base/search_extent.hpp"
#include "core/segment/chart_excess.hpp"
#include "core/segment/large_charts.hpp"
#include "core/segment/region_charts.hpp"
#include "core/segment/segment_symmetrically.hpp"
#include "core/segment/settle_forced.hpp"
#include "core/segment/tighten.hpp"
#include "core/segment/whole_chart.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kShareOfStandIn = 0.25;  // of the work, on the first stand-in
constexpr Index kAnyNumber = std::numeric_limits<Index>::max();

SegmentRules for_part_of_work(SegmentRules rules, double begin, double end) {
  rules.on_progress = part_of_progress(std::move(rules.on_progress), begin, end);
  return rules;
}

class ComponentSearch {
 public:
  ComponentSearch(const charts::Chart& component, const ComponentRules& rules, Executor& executor)
      : component_(component), given_(rules), executor_(executor) {}

  ComponentCharts run() {
    SegmentRules rules = given_.segment;
    std::vector<charts::Chart> parts;
    if (given_.may_stay_whole) parts = kept_whole(rules);
    if (parts.empty()) parts = segmented_charts(rules);
    return {std::move(parts), is_rough_};
  }

 private:
  /// A bound below kDefaultDistortion is reached from that, step by step (ADR 0066).
  std::vector<charts::Chart> segmented_charts(SegmentRules rules) {
    const TightBounds tight = tight_bounds(rules.max_distortion, rules.effort);
    const auto searches = static_cast<double>(tight.searched.size() + 1);
    rules.max_distortion = std::max(rules.max_distortion, kDefaultDistortion);
    std::vector<charts::Chart> parts;
    if (given_.may_stay_whole && tight.count > 0) parts = kept_whole(rules);
    if (parts.empty()) parts = parts_of(for_part_of_work(rules, 0, 1 / searches));
    const bool was_rough = std::exchange(is_rough_, false);
    std::vector<std::vector<charts::Chart>> found;
    for (const double bound : tight.searched) {
      const auto done = static_cast<double>(found.size() + 1);
      SegmentRules own = for_part_of_work(rules, done / searches, (done + 1) / searches);
      own.max_distortion = bound;
      found.push_back(parts_of(own));
      const bool is_rough = std::exchange(is_rough_, false);  // it keeps another bound
      if (is_rough || is_forced_in_vain(found.back(), parts)) found.back().clear();
    }
    for (std::size_t k = 0; k < tight.count; ++k) {
      rules.max_distortion = tight.searched[k];
      const std::size_t most = rules.effort == Effort::fast ? 1 : 2;
      const std::size_t count = std::min(most, found.size() - k);
      parts = tightened(std::move(parts), std::span(found).subspan(k, count), rules);
    }
    is_rough_ = is_rough_ || was_rough;
    return parts;
  }

  /// Whether charts for a tighter bound that had to be few have more distortion than the looser
  /// ones.
  [[nodiscard]] bool is_forced_in_vain(const std::vector<charts::Chart>& tighter,
                                       const std::vector<charts::Chart>& looser) const {
    const SegmentRules& rules = given_.segment;
    if (rules.most_regions == kAnyNumber) return false;
    const auto excess = [&](const std::vector<charts::Chart>& charts) {
      return chart_excess(charts, executor_, rules.stop).mean.worst();
    };
    return excess(tighter) > excess(looser);
  }

  /// Charts for a tighter bound, whose seams are not shorter than the looser ones': the best that
  /// were found within the bound, or where all of these are luckier, the looser ones split further.
  std::vector<charts::Chart> tightened(std::vector<charts::Chart> looser,
                                       std::span<const std::vector<charts::Chart>> found,
                                       SegmentRules rules) {
    rules.on_progress = {};
    const auto better = [&](const auto& one, const auto& other) {
      return is_better(seams_of(one), seams_of(other), rules.most_regions);
    };
    const std::vector<charts::Chart>* best = nullptr;
    for (const std::vector<charts::Chart>& own : found)
      if (!own.empty() && !better(own, looser) && (best == nullptr || better(own, *best)))
        best = &own;
    if (best != nullptr) return *best;
    const SplitChart split = [&](const charts::Chart& chart, double bound) {
      SegmentRules parts = rules_of_chart(rules, component_, chart);
      parts.max_distortion = bound;
      const charts::Chart alone = as_component(component_, chart);
      return settle_forced(alone, searched_parts(alone, parts), parts.stop);
    };
    return tighten(std::move(looser), rules.max_distortion, rules.most_regions, split, executor_,
                   rules.stop);
  }

  /// The disk as one chart, which then has all that regions have, if the bound holds; else none.
  std::vector<charts::Chart> kept_whole(const SegmentRules& rules) {
    std::optional<UvMap> uv = map_whole(component_, rules.max_distortion, executor_, rules.stop);
    if (!uv) return {};
    std::vector<charts::Chart> whole = {component_};
    whole.front().start = std::move(*uv);
    whole.front().least = Guarantee::bijective;
    return whole;
  }

  /// Settled before bounds are compared, since a map that overlaps may have any seams.
  std::vector<charts::Chart> parts_of(const SegmentRules& rules) {
    std::vector<charts::Chart> parts;
    if (given_.symmetry == Symmetry::automatic) parts = symmetric_parts(rules);
    if (parts.empty()) parts = searched_parts(component_, rules);
    return settle_forced(component_, std::move(parts), rules.stop);
  }

  /// None where there is no mirror, or where the component is too large to be searched whole.
  std::vector<charts::Chart> symmetric_parts(const SegmentRules& rules) {
    if (component_.mesh.face_count() / 2 > search_extent(rules.effort).second.beyond) return {};
    const SegmentationMesh surface = make_segmentation_mesh(component_);
    const std::optional<Mirror> mirror = find_mirror(surface.mesh, surface.halfedges, rules.stop);
    if (!mirror) return {};
    const auto segments = segment_symmetrically(component_, surface, *mirror, rules, executor_);
    return segments ? region_charts(component_, *segments) : std::vector<charts::Chart>();
  }

  /// On a small surface that stands for the component, on a larger one, or on its own.
  std::vector<charts::Chart> searched_parts(const charts::Chart& component, SegmentRules rules) {
    const SearchExtent extent = search_extent(rules.effort);
    const Index faces = component.mesh.face_count();
    if (faces > extent.first.beyond) {
      auto found = large_charts_within_bound(component, for_part_of_work(rules, 0, kShareOfStandIn),
                                             extent.first.faces, executor_);
      if (found) return std::move(*found);
      rules = for_part_of_work(rules, kShareOfStandIn, 1);
    }
    if (faces <= extent.second.beyond) {
      const SegmentationMesh surface = make_segmentation_mesh(component);
      return region_charts(component, segment(surface, rules, executor_));
    }
    LargeCharts large = large_charts(component, rules, extent.second, executor_);
    is_rough_ = is_rough_ || large.is_rough;
    return std::move(large.charts);
  }

  const charts::Chart& component_;
  const ComponentRules& given_;
  Executor& executor_;
  bool is_rough_ = false;
};

}  // namespace

ComponentCharts charts_within_bound(const charts::Chart& component, const ComponentRules& rules,
                                    Executor& executor) {
  return ComponentSearch(component, rules, executor).run();
}

}  // namespace unwrapd::segment
