#include "core/segment/base/region_mesh.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/mesh/topology.hpp"
#include "core/segment/base/ranks.hpp"

namespace unwrapd::segment {
namespace {

constexpr std::size_t kRim = 8;            // times as many faces as are new
constexpr std::size_t kLeastMoving = 100;  // faces

Halfedges glued(const SegmentationMesh& surface, std::span<const char> open,
                std::span<const Index> faces) {
  const Ranks rank(surface.mesh.faces.size(), faces);
  Halfedges own;
  own.twin.reserve(3 * faces.size());
  for (const Index t : faces)
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index twin = open.empty() || open[h] == 0 ? surface.halfedges.twin[h] : kNoTwin;
      const bool inside = twin != kNoTwin && rank[face_of(twin)] != kNoTwin;
      own.twin.push_back(inside ? 3 * rank[face_of(twin)] + twin % 3 : kNoTwin);
    }
  return own;
}

/// Adds the faces that are reached from these across sides, the near ones first, until there are
/// `enough`. seen: one a face, 1: it is among them.
void flood(const Halfedges& halfedges, std::size_t enough, std::vector<char>& seen,
           std::vector<Index>& faces) {
  for (std::size_t k = 0; k < faces.size() && faces.size() < enough; ++k)
    for (Index h = 3 * faces[k]; h < 3 * faces[k] + 3; ++h) {
      const Index twin = halfedges.twin[h];
      if (twin == kNoTwin || std::exchange(seen[face_of(twin)], 1) != 0) continue;
      faces.push_back(face_of(twin));
    }
}

std::vector<Index> moving_faces(const RegionMesh& region, std::size_t mapped) {
  const std::size_t count = region.mesh.faces.size();
  std::vector<Index> faces(count - mapped);
  std::iota(faces.begin(), faces.end(), static_cast<Index>(mapped));
  if (mapped == 0) return faces;
  std::vector<char> seen(count, 0);
  for (const Index t : faces) seen[t] = 1;
  flood(region.halfedges, moving_count(faces.size()), seen, faces);
  std::ranges::sort(faces);
  return faces;
}

/// The vertices of the faces, sorted by rank; those that are one on the surface as they come.
std::vector<Index> sorted_vertices(const RegionMesh& region, std::span<const Index> faces) {
  std::vector<char> seen(region.mesh.positions.size(), 0);
  std::vector<std::uint64_t> keys;
  for (const Index t : faces)
    for (const Index v : region.mesh.faces[t])
      if (std::exchange(seen[v], 1) == 0)
        keys.push_back(static_cast<std::uint64_t>(region.rank[v]) << 32 |
                       static_cast<std::uint64_t>(v));
  std::ranges::sort(keys);
  std::vector<Index> vertices;
  vertices.reserve(keys.size());
  for (const std::uint64_t key : keys) vertices.push_back(static_cast<Index>(key & 0xffffffff));
  return vertices;
}

/// Where the faces that do not move have vertices of those that do. number: of each vertex among
/// those that move; kNoTwin: not there.
solve::VertexConstraints held_vertices(const RegionMesh& region, std::span<const Index> moving,
                                       std::vector<Index> number, std::span<const CornerUv> uv) {
  solve::VertexConstraints held;
  auto next = moving.begin();
  for (std::size_t t = 0; t < region.mesh.faces.size(); ++t) {
    if (next != moving.end() && static_cast<std::size_t>(*next) == t) {
      ++next;
      continue;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Index v = std::exchange(number[region.mesh.faces[t][i]], kNoTwin);
      if (v != kNoTwin) held.hard.push_back({v, uv[t][i]});
    }
  }
  return held;
}

}  // namespace

RegionMesh region_mesh(const SegmentationMesh& surface, std::span<const char> open,
                       std::span<const Index> faces) {
  RegionMesh region{{}, glued(surface, open, faces), {}, {}, {}};
  CornerVertices corners = corner_vertices(region.halfedges);
  region.mesh = {std::vector<Vec3>(corners.count), std::move(corners.faces)};
  region.rank.resize(corners.count);
  region.rest.reserve(faces.size());
  for (std::size_t k = 0; k < faces.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Index own = region.mesh.faces[k][i], v = surface.mesh.faces[faces[k]][i];
      region.mesh.positions[own] = surface.mesh.positions[v];
      region.rank[own] = surface.rank[v];
    }
    region.rest.push_back(surface.rest[faces[k]]);
  }
  region.loops = boundary_loops(region.mesh, region.halfedges);
  return region;
}

std::size_t moving_count(std::size_t new_count) { return std::max(kRim * new_count, kLeastMoving); }

bool is_disk(const RegionMesh& region) {
  const auto face_count = static_cast<Index>(region.mesh.faces.size());
  Index sides = 0;
  for (const BoundaryLoop& loop : region.loops) sides += static_cast<Index>(loop.size());
  const Index euler = region.mesh.vertex_count() - (3 * face_count + sides) / 2 + face_count;
  if (region.loops.empty() || euler != 2 - static_cast<Index>(region.loops.size())) return false;
  std::vector<char> reached(region.mesh.faces.size(), 0);
  std::vector<Index> pending{0};
  reached[0] = 1;
  flood(region.halfedges, region.mesh.faces.size(), reached, pending);
  return pending.size() == region.mesh.faces.size();
}

MovingPart moving_part(const RegionMesh& region, std::size_t mapped, std::span<const CornerUv> uv) {
  MovingPart part{moving_faces(region, mapped), {}, {}, {}};
  part.vertices = sorted_vertices(region, part.faces);
  std::vector<Index> number(region.mesh.positions.size(), kNoTwin);
  for (std::size_t k = 0; k < part.vertices.size(); ++k)
    number[part.vertices[k]] = static_cast<Index>(k);
  part.corners.reserve(part.faces.size());
  for (const Index t : part.faces) {
    const auto& [a, b, c] = region.mesh.faces[t];
    part.corners.push_back({number[a], number[b], number[c]});
  }
  if (part.faces.size() < region.mesh.faces.size())
    part.held = held_vertices(region, part.faces, std::move(number), uv);
  return part;
}

}  // namespace unwrapd::segment
