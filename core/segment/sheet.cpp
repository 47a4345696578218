#include "core/segment/sheet.hpp"

#include <Eigen/Geometry>

#include <cmath>

#include "core/linear/ordering.hpp"
#include "core/linear/sparse.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd {
namespace {

constexpr double kSharp = 0.788;  // the cosine of 38 degrees between two faces
constexpr double kCostOfCrease = 0.7;
constexpr double kMostCreases = 0.4;  // of all inner edges

/// Recentred and scaled to area 1, so that nothing that follows depends on place or scale.
TriMesh normalised(const TriMesh& mesh) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : mesh.positions) centre += p / static_cast<double>(mesh.vertex_count());
  const double unit = std::sqrt(surface_area(mesh));
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
std::vector<double> seam_costs(const Sheet& sheet, std::span<const char> given) {
  std::vector<double> cost = sheet.length;
  std::size_t inner = 0, creases = 0;
  for (std::size_t h = 0; h < cost.size(); ++h) {
    const Index twin = sheet.halfedges.twin[h];
    if (twin == kNoTwin) continue;
    const double cosine = sheet.normal[h / 3].dot(sheet.normal[face_of(twin)]);
    const bool is_crease = cosine < kSharp || (!given.empty() && given[h] != 0);
    inner += 1;
    creases += is_crease ? 1 : 0;
    if (is_crease) cost[h] *= kCostOfCrease;
  }
  return kMostCreases * static_cast<double>(inner) < static_cast<double>(creases) ? sheet.length
                                                                                  : cost;
}

std::vector<Index> elimination_ranks(const TriMesh& mesh) {
  const std::vector<double> weight(3 * mesh.faces.size(), 1);
  const SparseMatrix lower = lower_laplacian(mesh.faces, mesh.vertex_count(), weight);
  const std::span begin(lower.outerIndexPtr(), mesh.positions.size() + 1);
  const std::span row(lower.innerIndexPtr(), static_cast<std::size_t>(lower.nonZeros()));
  const std::vector<Index> order = fill_reducing_order(graph_of_lower(begin, row));
  std::vector<Index> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[order[k]] = static_cast<Index>(k);
  return rank;
}

}  // namespace

Sheet make_sheet(const TriMesh& mesh, const Halfedges& halfedges, std::span<const char> crease) {
  Sheet sheet{normalised(mesh), halfedges, {}, {}, {}, {}, {}};
  sheet.rest = flatten(sheet.mesh);
  sheet.normal.reserve(mesh.faces.size());
  for (const Triangle& face : mesh.faces) sheet.normal.push_back(normal_of(sheet.mesh, face));
  sheet.length.reserve(halfedges.twin.size());
  for (Index h = 0; h < static_cast<Index>(halfedges.twin.size()); ++h)
    sheet.length.push_back((sheet.mesh.positions[end_of(mesh.faces, h)] -
                            sheet.mesh.positions[start_of(mesh.faces, h)])
                               .norm());
  sheet.seam_cost = seam_costs(sheet, crease);
  sheet.rank = elimination_ranks(sheet.mesh);
  return sheet;
}

std::vector<CornerUv> projected(const Sheet& sheet, std::span<const Index> faces) {
  Vec3 mean = Vec3::Zero();
  for (Index t : faces) mean += sheet.area(t) * sheet.normal[t];
  const Vec3 up = mean.norm() > 0 ? Vec3(mean.normalized()) : sheet.normal[faces.front()];
  const Vec3 right = up.unitOrthogonal(), ahead = up.cross(right);
  std::vector<CornerUv> uv(faces.size());
  for (std::size_t k = 0; k < faces.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = sheet.mesh.positions[sheet.mesh.faces[faces[k]][i]];
      uv[k][i] = Vec2(p.dot(right), p.dot(ahead));
    }
  return uv;
}

}  // namespace unwrapd
