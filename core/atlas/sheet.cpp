#include "core/atlas/sheet.hpp"

#include <Eigen/Geometry>

#include <cmath>

#include "core/mesh/edges.hpp"

namespace unwrapd {
namespace {

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

}  // namespace

Sheet make_sheet(const TriMesh& mesh, const Halfedges& halfedges) {
  Sheet sheet{normalised(mesh), halfedges, {}, {}, {}};
  sheet.rest = flatten(sheet.mesh);
  sheet.normal.reserve(mesh.faces.size());
  for (const Triangle& face : mesh.faces) sheet.normal.push_back(normal_of(sheet.mesh, face));
  sheet.length.reserve(halfedges.twin.size());
  for (Index h = 0; h < static_cast<Index>(halfedges.twin.size()); ++h)
    sheet.length.push_back((sheet.mesh.positions[end_of(mesh.faces, h)] -
                            sheet.mesh.positions[start_of(mesh.faces, h)])
                               .norm());
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
