// Whether to take a component apart is a rule, not a guess: a disk is what someone opened on
// purpose, or what needs no seam, and stays one chart unless a bound of distortion is asked for.
// Everything else needs seams anyway, and then the best ones. So does a disk whose boundary is a
// mere puncture: by the isoperimetric inequality it would have to be drawn out tenfold to enclose
// the disk's area.
#include "core/segment/segment_charts.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/mesh/edges.hpp"
#include "core/segment/large_charts.hpp"
#include "core/segment/region_charts.hpp"

namespace unwrapd {
namespace {

constexpr double kLeastOpenness = 0.01;  // 1 / 10^2
constexpr Index kMostFacesSegmented = 18'000;

/// The square of how long the boundary is beside that of a flat round disk of the same area.
double openness(const Chart& component) {
  const TriMesh& mesh = component.mesh;
  double length = 0;
  for (const BoundaryLoop& loop : component.loops)
    for (const Index h : loop)
      length +=
          (mesh.positions[end_of(mesh.faces, h)] - mesh.positions[start_of(mesh.faces, h)]).norm();
  return length * length / (4 * std::numbers::pi * surface_area(mesh));
}

/// Where the segmentation of all components stands: they weigh by their faces.
class Account {
 public:
  Account(const std::vector<Charts>& surfaces, const SegmentWatch& watch) : watch_(watch) {
    for (const Charts& surface : surfaces)
      for (const Chart& component : surface.charts) {
        total_ += faces_of(component);
        area_ += surface_area(component.mesh);
      }
  }

  [[nodiscard]] SegmentRules rules(double max_distortion, const Chart& component) const {
    return {.max_distortion = max_distortion,
            .page_area = area_ / surface_area(component.mesh),
            .on_progress =
                [this, &component](Stage stage, double share) {
                  if (watch_.on_progress)
                    watch_.on_progress(stage, (done_ + share * faces_of(component)) / total_);
                },
            .stop = watch_.stop};
  }
  [[nodiscard]] const std::stop_token& stop() const { return watch_.stop; }
  void finish(std::size_t faces) { done_ += static_cast<double>(faces); }

 private:
  static double faces_of(const Chart& component) {
    return static_cast<double>(component.mesh.faces.size());
  }

  const SegmentWatch& watch_;
  double total_ = 0, done_ = 0;
  double area_ = 0;  ///< in space, of all components
};

void note(Charts& surface, RepairKind kind, Index count) {
  if (count > 0) surface.repairs.push_back({kind, 0, count});
}

/// What is done with components, one after another.
class Cutter {
 public:
  Cutter(const SegmentOptions& options, const Account& account, Executor& executor)
      : options_(options), account_(account), executor_(executor) {}

  /// most: charts that it shall become at most.
  void add(Chart component, Index most) {
    throw_if_cancelled(account_.stop());
    const bool whole = is_disk(component), one_chart = options_.one_chart_each || most == 1;
    const bool is_left = !options_.max_distortion && openness(component) >= kLeastOpenness;
    if (!one_chart && !(whole && is_left)) return take_apart(component, whole, most);
    if (!whole) {
      cut(component);
      ++cuts;
    }
    charts.push_back(std::move(component));
  }

  std::vector<Chart> charts;
  Index cuts = 0, segmented = 0, rough = 0;

 private:
  void take_apart(const Chart& component, bool whole, Index most) {
    SegmentRules rules =
        account_.rules(options_.max_distortion.value_or(kDefaultDistortion), component);
    rules.most_regions = most;
    std::vector<Chart> parts = component.mesh.face_count() > kMostFacesSegmented
                                   ? parts_of_large(component, rules)
                                   : parts_of_small(component, rules);
    segmented += !whole || parts.size() > 1 ? 1 : 0;
    for (Chart& part : parts) charts.push_back(std::move(part));
  }

  std::vector<Chart> parts_of_small(const Chart& component, const SegmentRules& rules) {
    const Sheet sheet = make_sheet(component.mesh, component.halfedges, component.crease);
    return region_charts(component, segment(sheet, rules, executor_));
  }

  std::vector<Chart> parts_of_large(const Chart& component, const SegmentRules& rules) {
    LargeCharts large = large_charts(component, rules, executor_);
    rough += large.is_rough ? 1 : 0;
    return std::move(large.charts);
  }

  const SegmentOptions& options_;
  const Account& account_;
  Executor& executor_;
};

/// How many charts each component may become, in the order of surfaces and components.
using Quotas = std::vector<Index>;

/// What cutting came to.
struct Cuts {
  Quotas became;    ///< how many charts each component
  Index rough = 0;  ///< components where noise leaves no room for the bound
};

Cuts cut_all(std::vector<Charts>& surfaces, const Quotas& most, const SegmentOptions& options,
             const SegmentWatch& watch, Executor& executor) {
  Account account(surfaces, watch);
  Cuts cuts;
  for (Charts& surface : surfaces) {
    Cutter cutter(options, account, executor);
    for (Chart& component : std::exchange(surface.charts, {})) {
      const std::size_t faces = component.mesh.faces.size(), before = cutter.charts.size();
      cutter.add(std::move(component), most[cuts.became.size()]);
      cuts.became.push_back(static_cast<Index>(cutter.charts.size() - before));
      account.finish(faces);
    }
    surface.charts = std::move(cutter.charts);
    cuts.rough += cutter.rough;
    note(surface, RepairKind::cut_to_disk, cutter.cuts);
    note(surface, RepairKind::segmented, cutter.segmented);
  }
  return cuts;
}

/// One chart for each component; what is left of `most` goes by how many they would like.
Quotas shared_out(Quotas wanted, Index total, Index most) {
  const auto count = static_cast<Index>(wanted.size());
  const std::int64_t spare = std::max(most - count, 0);
  for (Index& own : wanted)
    own = 1 + static_cast<Index>(spare * (own - 1) / std::max(total - count, 1));
  return wanted;
}

std::string more_than_asked(Index charts, Index components) {
  return "More charts than max_charts are needed: " + std::to_string(charts) +
         ", for the mesh has " + std::to_string(components) +
         " pieces, and no two charts that are left have a common map without overlaps.";
}

std::string rough_surfaces(Index count) {
  return "The noise of " + std::to_string(count) +
         " of the surfaces leaves no room for max_distortion, which was kept on a smoothed one.";
}

}  // namespace

std::string segment_charts(std::vector<Charts>& surfaces, const SegmentOptions& options,
                           const SegmentWatch& watch, Executor& executor) {
  Index components = 0;
  for (const Charts& surface : surfaces) components += static_cast<Index>(surface.charts.size());
  const bool is_limited = options.max_charts.has_value();
  const Index most = options.max_charts.value_or(std::numeric_limits<Index>::max());
  const Quotas first(static_cast<std::size_t>(components),
                     is_limited ? std::max<Index>(most - components + 1, 1) : most);
  const std::vector<Charts> whole = is_limited ? surfaces : std::vector<Charts>();
  Cuts cuts = cut_all(surfaces, first, options, watch, executor);
  const auto charts = [&] {
    return std::accumulate(cuts.became.begin(), cuts.became.end(), Index(0));
  };
  Index total = charts();
  if (total > most && components > 1) {
    surfaces = whole;
    cuts = cut_all(surfaces, shared_out(std::move(cuts.became), total, most), options,
                   {{}, watch.stop}, executor);
    total = charts();
  }
  if (total > most) return more_than_asked(total, components);
  return cuts.rough > 0 ? rough_surfaces(cuts.rough) : std::string();
}

}  // namespace unwrapd
