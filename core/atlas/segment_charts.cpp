// Whether to take a component apart is a rule, not a guess: a disk is what someone opened on
// purpose, or what needs no seam, and stays one chart unless a bound of distortion is asked for.
// Everything else needs seams anyway, and then the best ones. So does a disk whose boundary is a
// mere puncture: by the isoperimetric inequality it would have to be drawn out tenfold to enclose
// the disk's area.
#include "core/atlas/segment_charts.hpp"

#include <numbers>
#include <utility>

#include "core/atlas/segment.hpp"
#include "core/atlas/split_chart.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd {
namespace {

constexpr double kLeastOpenness = 0.01;  // 1 / 10^2

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
      for (const Chart& component : surface.charts) total_ += faces_of(component);
  }

  [[nodiscard]] SegmentRules rules(double max_distortion, const Chart& component) const {
    return {.max_distortion = max_distortion,
            .on_progress =
                [this, &component](Stage stage, double share) {
                  if (watch_.on_progress)
                    watch_.on_progress(stage, (done_ + share * faces_of(component)) / total_);
                },
            .stop = watch_.stop};
  }
  void finish(std::size_t faces) { done_ += static_cast<double>(faces); }

 private:
  static double faces_of(const Chart& component) {
    return static_cast<double>(component.mesh.faces.size());
  }

  const SegmentWatch& watch_;
  double total_ = 0, done_ = 0;
};

/// The regions as charts; their maps are what solving may begin with.
std::vector<Chart> charts_of(const Chart& component, const Segments& segments) {
  const std::vector<Region>& regions = segments.regions;
  std::vector<Index> owner(component.mesh.faces.size());
  std::vector<CornerUv> uv(owner.size());
  for (std::size_t k = 0; k < regions.size(); ++k)
    for (std::size_t i = 0; i < regions[k].faces.size(); ++i) {
      owner[regions[k].faces[i]] = static_cast<Index>(k);
      uv[regions[k].faces[i]] = regions[k].uv[i];
    }
  Halfedges cut = component.halfedges;
  for (std::size_t h = 0; h < cut.twin.size(); ++h)
    if (cut.twin[h] != kNoTwin &&
        (segments.open[h] != 0 || owner[face_of(cut.twin[h])] != owner[h / 3]))
      cut.twin[h] = kNoTwin;
  std::vector<Chart> charts;
  for (ChartPart& part : parts_of(component, cut)) {
    part.chart.start.resize(part.vertex.size());
    for (std::size_t t = 0; t < part.face.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        part.chart.start[part.chart.mesh.faces[t][i]] = uv[part.face[t]][i];
    part.chart.least = Guarantee::bijective;
    charts.push_back(std::move(part.chart));
  }
  return charts;
}

void note(Charts& surface, RepairKind kind, Index count) {
  if (count > 0) surface.repairs.push_back({kind, 0, count});
}

/// What is done with a surface's components, one after another.
class Cutter {
 public:
  Cutter(const SegmentOptions& options, const Account& account, Executor& executor)
      : options_(options), account_(account), executor_(executor) {}

  void add(Chart component) {
    const bool whole = is_disk(component);
    if (whole && options_.one_chart_each) {
      charts.push_back(std::move(component));
    } else if (whole && !options_.max_distortion && openness(component) >= kLeastOpenness) {
      charts.push_back(std::move(component));
    } else if (options_.one_chart_each) {
      cut(component);
      ++cuts;
      charts.push_back(std::move(component));
    } else {
      take_apart(std::move(component), whole);
    }
  }

  std::vector<Chart> charts;
  Index cuts = 0, segmented = 0;

 private:
  void take_apart(Chart component, bool whole) {
    const double bound = options_.max_distortion.value_or(kDefaultDistortion);
    const Sheet sheet = make_sheet(component.mesh, component.halfedges);
    const Segments segments = segment(sheet, account_.rules(bound, component), executor_);
    segmented += !whole || segments.regions.size() > 1 ? 1 : 0;
    for (Chart& chart : charts_of(component, segments)) charts.push_back(std::move(chart));
  }

  const SegmentOptions& options_;
  const Account& account_;
  Executor& executor_;
};

}  // namespace

std::string segment_charts(std::vector<Charts>& surfaces, const SegmentOptions& options,
                           const SegmentWatch& watch, Executor& executor) {
  Account account(surfaces, watch);
  for (Charts& surface : surfaces) {
    Cutter cutter(options, account, executor);
    for (Chart& component : std::exchange(surface.charts, {})) {
      const std::size_t faces = component.mesh.faces.size();
      cutter.add(std::move(component));
      account.finish(faces);
    }
    surface.charts = std::move(cutter.charts);
    note(surface, RepairKind::cut_to_disk, cutter.cuts);
    note(surface, RepairKind::segmented, cutter.segmented);
  }
  return {};
}

}  // namespace unwrapd
