#include "core/segment/base/segmentation_mesh.hpp"

#include <Eigen/Geometry>

#include <cmath>

#include "core/charts/seam_weight.hpp"
#include "core/linear/ordering.hpp"
#include "core/linear/sparse.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kSharp = 0.788;  // the cosine of 38 degrees between two faces
constexpr double kCostOfCrease = 0.7;
constexpr double kMostCreases = 0.4;  // of all inner edges

/// Recentred and scaled to area 1, so that nothing that follows depends on place or scale.
TriMesh normalised(const TriMesh& mesh) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : mesh.positions) centre += p / static_cast<double>(mesh.vertex_count());
  const double unit = std::sqrt(measure::surface_area(mesh));
  TriMesh scaled = mesh;
  for (Vec3& p : scaled.positions) p = (p - centre) / unit;
  return scaled;
}

Vec3 normal_of(const TriMesh& mesh, const Triangle& face) {
  const Vec3 ab = mesh.positions[face[1]] - mesh.positions[face[0]];
  const Vec3 ac = mesh.positions[face[2]] - mesh.positions[face[0]];
  return ab.cross(ac).stableNormalized();
}

/// One a half-edge.
std::vector<double> seam_costs(const SegmentationMesh& surface, std::span<const char> given) {
  std::vector<double> cost = surface.length;
  std::size_t inner = 0, creases = 0;
  for (std::size_t h = 0; h < cost.size(); ++h) {
    const Index twin = surface.halfedges.twin[h];
    if (twin == kNoTwin) continue;
    const double cosine = surface.normal[h / 3].dot(surface.normal[face_of(twin)]);
    const bool is_crease = cosine < kSharp || (!given.empty() && given[h] != 0);
    inner += 1;
    creases += is_crease ? 1 : 0;
    if (is_crease) cost[h] *= kCostOfCrease;
  }
  return kMostCreases * static_cast<double>(inner) < static_cast<double>(creases) ? surface.length
                                                                                  : cost;
}

std::vector<Index> elimination_ranks(const TriMesh& mesh) {
  const std::vector<double> weight(3 * mesh.faces.size(), 1);
  const linear::SparseMatrix lower =
      linear::lower_laplacian(mesh.faces, mesh.vertex_count(), weight);
  const std::span begin(lower.outerIndexPtr(), mesh.positions.size() + 1);
  const std::span row(lower.innerIndexPtr(), static_cast<std::size_t>(lower.nonZeros()));
  const std::vector<Index> order = linear::fill_reducing_order(linear::graph_of_lower(begin, row));
  std::vector<Index> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[order[k]] = static_cast<Index>(k);
  return rank;
}

}  // namespace

SegmentationMesh make_segmentation_mesh(const TriMesh& mesh, const Halfedges& halfedges,
                                        std::span<const char> crease,
                                        std::span<const double> avoid) {
  SegmentationMesh surface{normalised(mesh), halfedges, {}, {}, {}, {}, {}, {}};
  surface.rest = measure::flatten(surface.mesh);
  surface.normal.reserve(mesh.faces.size());
  for (const Triangle& face : mesh.faces) surface.normal.push_back(normal_of(surface.mesh, face));
  surface.length.reserve(halfedges.twin.size());
  for (Index h = 0; h < static_cast<Index>(halfedges.twin.size()); ++h) {
    const bool is_border = halfedges.twin[h] == kNoTwin;
    surface.length.push_back(
        (is_border && charts::is_kept(avoid, h) ? 1 : charts::seam_weight(avoid, h)) *
        (surface.mesh.positions[end_of(mesh.faces, h)] -
         surface.mesh.positions[start_of(mesh.faces, h)])
            .norm());
    if (is_border || !charts::is_kept(avoid, h)) continue;
    surface.kept.resize(halfedges.twin.size(), 0);
    surface.kept[h] = 1;
  }
  surface.seam_cost = seam_costs(surface, crease);
  surface.rank = elimination_ranks(surface.mesh);
  return surface;
}

SegmentationMesh make_segmentation_mesh(const charts::Chart& component) {
  return make_segmentation_mesh(component.mesh, component.halfedges, component.crease,
                                component.avoid);
}

std::vector<CornerUv> projected(const SegmentationMesh& surface, std::span<const Index> faces) {
  Vec3 mean = Vec3::Zero();
  for (Index t : faces) mean += surface.area(t) * surface.normal[t];
  const Vec3 up = mean.norm() > 0 ? Vec3(mean.normalized()) : surface.normal[faces.front()];
  const Vec3 right = up.unitOrthogonal(), ahead = up.cross(right);
  std::vector<CornerUv> uv(faces.size());
  for (std::size_t k = 0; k < faces.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = surface.mesh.positions[surface.mesh.faces[faces[k]][i]];
      uv[k][i] = Vec2(p.dot(right), p.dot(ahead));
    }
  return uv;
}

}  // namespace unwrapd::segment
