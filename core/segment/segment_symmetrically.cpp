#include "core/segment/segment_symmetrically.hpp"

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include "core/charts/split_chart.hpp"
#include "core/mesh/edges.hpp"
#include "core/segment/join_symmetrically.hpp"

namespace unwrapd::segment {
namespace {

/// The halves are searched for this share of the first bound, too, so that joining them has the
/// rest.
constexpr double kForJoining = 0.5;

/// A seam in front has its image behind: it is to avoid what is painted at either place.
void average_with_image(const charts::Chart& component, const Mirror& mirror,
                        charts::ChartPart& part) {
  for (std::size_t h = 0; h < part.chart.avoid.size(); ++h) {
    const Index image = mirror.halfedge[3 * part.face[h / 3] + static_cast<Index>(h % 3)];
    if (image >= 0) part.chart.avoid[h] = (part.chart.avoid[h] + component.avoid[image]) / 2;
  }
}

/// The parts of the component in front of the plane.
std::vector<charts::ChartPart> front_parts(const charts::Chart& component, const Mirror& mirror,
                                           const std::stop_token& stop) {
  Halfedges cut = component.halfedges;
  for (std::size_t h = 0; h < cut.twin.size(); ++h)
    if (cut.twin[h] != kNoTwin && mirror.is_front[h / 3] != mirror.is_front[face_of(cut.twin[h])])
      cut.twin[h] = kNoTwin;
  std::vector<charts::ChartPart> parts = charts::parts_of(component, cut, stop);
  std::erase_if(parts, [&](const charts::ChartPart& part) {
    return mirror.is_front[part.face.front()] == 0;
  });
  for (charts::ChartPart& part : parts) average_with_image(component, mirror, part);
  return parts;
}

/// The search for the regions of one part in front.
class FrontSearch {
 public:
  FrontSearch(const charts::Chart& component, const SegmentationMesh& whole, charts::ChartPart part,
              SegmentRules rules, std::size_t steps, Executor& executor)
      : part_(std::move(part)),
        surface_(make_segmentation_mesh(part_.chart.mesh, part_.chart.halfedges,
                                        creases_of(component, part_), part_.chart.avoid)) {
    for (const Index t : part_.face) area_ += whole.area(t);
    rules.page_area /= area_;
    search_.emplace(surface_, std::move(rules), steps, executor);
  }

  /// The regions for an excess that is not less than the last one.
  FrontRegions regions(double excess) {
    if (!segments_)
      segments_ = search_->first(excess);
    else if (excess > excess_)
      if (std::optional<Segments> next = search_->loosen(excess)) segments_ = std::move(*next);
    excess_ = excess;
    return {part_, *segments_, area_};
  }

 private:
  static std::vector<char> creases_of(const charts::Chart& component,
                                      const charts::ChartPart& part) {
    std::vector<char> crease;
    if (component.crease.empty()) return crease;
    for (const Index t : part.face)
      for (Index h = 3 * t; h < 3 * t + 3; ++h) crease.push_back(component.crease[h]);
    return crease;
  }

  const charts::ChartPart part_;
  const SegmentationMesh surface_;
  double area_ = 0;
  std::optional<SurfaceSegmentation> search_;
  std::optional<Segments> segments_;
  double excess_ = 0;
};

/// Images of seams lie where edges are kept, if the mesh is not quite symmetric.
bool keeps_edges(const SegmentationMesh& surface, const Segments& segments) {
  if (surface.kept.empty()) return true;
  std::vector<Index> owner(surface.rest.size());
  for (std::size_t k = 0; k < segments.regions.size(); ++k)
    for (const Index t : segments.regions[k].faces) owner[t] = static_cast<Index>(k);
  for (Index h = 0; h < static_cast<Index>(surface.kept.size()); ++h)
    if (surface.kept[h] != 0 &&
        (segments.open[h] != 0 || owner[face_of(h)] != owner[face_of(surface.halfedges.twin[h])]))
      return false;
  return true;
}

/// The rules for one of some parts: half of the regions, and its share of the progress.
SegmentRules rules_for(const SegmentRules& rules, std::size_t part, std::size_t count) {
  SegmentRules own = rules;
  own.most_regions = std::max(1, rules.most_regions / 2);
  const auto parts = static_cast<double>(count), begin = static_cast<double>(part);
  own.on_progress = part_of_progress(rules.on_progress, begin / parts, (begin + 1) / parts);
  return own;
}

}  // namespace

std::optional<Segments> segment_symmetrically(const charts::Chart& component,
                                              const SegmentationMesh& surface, const Mirror& mirror,
                                              const SegmentRules& rules, Executor& executor) {
  const std::vector<double> steps = excess_steps(rules.max_distortion, rules.effort);
  std::vector<charts::ChartPart> parts = front_parts(component, mirror, rules.stop);
  std::deque<FrontSearch> searches;
  for (std::size_t k = 0; k < parts.size(); ++k)
    searches.emplace_back(component, surface, std::move(parts[k]),
                          rules_for(rules, k, parts.size()), steps.size(), executor);
  std::optional<Segments> best;
  double last = kForJoining * steps.front();
  for (const double excess : steps)
    for (const double own : {std::exchange(last, excess), excess}) {
      std::vector<FrontRegions> front;
      for (FrontSearch& search : searches) front.push_back(search.regions(own));
      auto next = join_symmetrically(surface, mirror, front, excess, rules.stop);
      if (!next) continue;
      if (!best || is_better(seams_of(*next), seams_of(*best), rules.most_regions))
        best = std::move(next);
    }
  if (!best || best->regions.size() > static_cast<std::size_t>(rules.most_regions))
    return std::nullopt;
  if (!keeps_edges(surface, *best)) return std::nullopt;
  return best;
}

}  // namespace unwrapd::segment
