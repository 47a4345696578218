#include "core/segment/region_charts.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/charts/seam_weight.hpp"
#include "core/charts/split_chart.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/mesh/edges.hpp"
#include "core/segment/transfer_seams.hpp"

namespace unwrapd::segment {
namespace {

/// What segmentation says of each face and half-edge.
struct Seamed {
  std::vector<CornerUv> uv;  ///< one a face: of its region's map
  std::vector<char> seam;    ///< one a half-edge, 1: open, or between regions
  std::vector<char> forced;  ///< one a face: its region is (Region::is_forced)
};

Seamed seamed(const Halfedges& halfedges, const Segments& segments) {
  const std::vector<Region>& regions = segments.regions;
  std::vector<Index> owner(halfedges.twin.size() / 3);
  Seamed seamed{std::vector<CornerUv>(owner.size()), segments.open,
                std::vector<char>(owner.size(), 0)};
  for (std::size_t k = 0; k < regions.size(); ++k)
    for (std::size_t i = 0; i < regions[k].faces.size(); ++i) {
      owner[regions[k].faces[i]] = static_cast<Index>(k);
      seamed.uv[regions[k].faces[i]] = regions[k].uv[i];
      seamed.forced[regions[k].faces[i]] = regions[k].is_forced ? 1 : 0;
    }
  for (std::size_t h = 0; h < halfedges.twin.size(); ++h) {
    const Index twin = halfedges.twin[h];
    if (twin != kNoTwin && owner[face_of(twin)] != owner[h / 3]) seamed.seam[h] = 1;
  }
  return seamed;
}

/// The plane map of a triangle in space as one of space: what lies beside it is projected.
class Extended {
 public:
  Extended(const TriMesh& mesh, const Triangle& face, const CornerUv& uv)
      : origin_(mesh.positions[face[0]]), image_(uv[0]) {
    Eigen::Matrix<double, 3, 2> sides;
    sides << mesh.positions[face[1]] - origin_, mesh.positions[face[2]] - origin_;
    Eigen::Matrix2d images;
    images << uv[1] - image_, uv[2] - image_;
    const Eigen::Matrix2d gram = sides.transpose() * sides;
    if (gram.determinant() > 0) turn_ = images * gram.inverse() * sides.transpose();
  }
  Vec2 operator()(const Vec3& p) const { return image_ + turn_ * (p - origin_); }

 private:
  Vec3 origin_;
  Vec2 image_;
  Eigen::Matrix<double, 2, 3> turn_ = Eigen::Matrix<double, 2, 3>::Zero();
};

/// The map of the small surface, smoothed by the way: each corner follows the triangle nearby.
UvMap transferred_map(const charts::ChartPart& part, const Coarse& coarse,
                      std::span<const CornerUv> uv, std::span<const Index> near,
                      const std::stop_token& stop) {
  UvMap map(part.vertex.size(), Vec2::Zero());
  std::vector<double> count(map.size(), 0);
  const TriMesh& mesh = part.chart.mesh;
  for (std::size_t t = 0; t < part.face.size(); ++t) {
    check_cancelled_every(t, stop);
    const Index n = near[part.face[t]];
    const Extended extended(coarse.mesh, coarse.mesh.faces[n], uv[n]);
    for (const Index v : mesh.faces[t]) {
      map[v] += extended(mesh.positions[v]);
      ++count[v];
    }
  }
  for (std::size_t v = 0; v < map.size(); ++v) map[v] /= count[v];
  return map;
}

double boundary_by(const charts::Chart& chart, std::span<const double> avoid) {
  const TriMesh& mesh = chart.mesh;
  double length = 0;
  for (const BoundaryLoop& loop : chart.loops)
    for (const Index h : loop)
      length +=
          charts::seam_weight(avoid, h) *
          (mesh.positions[end_of(mesh.faces, h)] - mesh.positions[start_of(mesh.faces, h)]).norm();
  return length;
}

}  // namespace

double boundary_length(const charts::Chart& chart) { return boundary_by(chart, {}); }

double weighted_boundary(const charts::Chart& chart) { return boundary_by(chart, chart.avoid); }

SeamsOfCharts seams_of(std::span<const charts::Chart> charts) {
  SeamsOfCharts seams{charts.size(), 0};
  for (const charts::Chart& chart : charts) seams.length += weighted_boundary(chart);
  return seams;
}

charts::Chart as_component(const charts::Chart& component, const charts::Chart& chart) {
  charts::Chart alone = chart;
  alone.crease.clear();
  if (component.crease.empty()) return alone;
  for (const Index face : chart.face_source) {
    const auto at = std::ranges::lower_bound(component.face_source, face);
    const auto h = component.crease.begin() + 3 * (at - component.face_source.begin());
    alone.crease.insert(alone.crease.end(), h, h + 3);
  }
  return alone;
}

SegmentRules rules_of_chart(SegmentRules rules, const charts::Chart& component,
                            const charts::Chart& chart) {
  rules.page_area *= measure::surface_area(component.mesh) / measure::surface_area(chart.mesh);
  return rules;
}

std::vector<charts::Chart> region_charts(const charts::Chart& component, const Segments& segments) {
  const auto [uv, seam, forced] = seamed(component.halfedges, segments);
  Halfedges cut = component.halfedges;
  for (std::size_t h = 0; h < cut.twin.size(); ++h)
    if (seam[h] != 0) cut.twin[h] = kNoTwin;
  std::vector<charts::Chart> charts;
  for (charts::ChartPart& part : charts::parts_of(component, cut)) {
    part.chart.start.resize(part.vertex.size());
    for (std::size_t t = 0; t < part.face.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        part.chart.start[part.chart.mesh.faces[t][i]] = uv[part.face[t]][i];
    if (forced[part.face.front()] == 0) part.chart.least = Guarantee::bijective;
    charts.push_back(std::move(part.chart));
  }
  return charts;
}

std::vector<charts::Chart> region_charts(const charts::Chart& component, const Coarse& coarse,
                                         const Segments& segments, const std::stop_token& stop) {
  const auto [uv, seam, forced] = seamed(coarse.halfedges, segments);
  const TransferredSeams transferred =
      transfer_seams(component.mesh, component.halfedges, coarse, seam, stop);
  std::vector<charts::Chart> charts;
  for (charts::ChartPart& part : charts::parts_of(component, transferred.cut, stop)) {
    part.chart.start = transferred_map(part, coarse, uv, transferred.near, stop);
    if (forced[transferred.near[part.face.front()]] == 0) part.chart.least = Guarantee::bijective;
    charts.push_back(std::move(part.chart));
  }
  return charts;
}

}  // namespace unwrapd::segment
