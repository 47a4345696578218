#include "core/measure/seam_length.hpp"

#include <numeric>

#include "core/base/cancel.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd::measure {
namespace {

/// Whether two corners, given by the half-edges that start there, have different UVs.
bool is_apart(const UnwrappedSurface& unwrapped, Index g, Index h) {
  const auto a = static_cast<std::size_t>(start_of(unwrapped.faces, g));
  const auto b = static_cast<std::size_t>(start_of(unwrapped.faces, h));
  return a != b && unwrapped.uv[a] != unwrapped.uv[b];
}

/// Whether the face of a half-edge has corners of equal UV.
bool is_collapsed(const UnwrappedSurface& unwrapped, Index h) {
  const Index next = next_halfedge(h), previous = previous_halfedge(h);
  return !is_apart(unwrapped, h, next) || !is_apart(unwrapped, next, previous) ||
         !is_apart(unwrapped, previous, h);
}

/// Whether the two sides of an edge have different UVs and both faces have area on the page. A face
/// without area lies on one of its edges, and its other edges are no seams.
bool is_seam(const UnwrappedSurface& unwrapped, Index h, Index twin) {
  const bool is_open =
      is_apart(unwrapped, h, next_halfedge(twin)) || is_apart(unwrapped, next_halfedge(h), twin);
  return is_open && !is_collapsed(unwrapped, h) && !is_collapsed(unwrapped, twin);
}

}  // namespace

Halfedges halfedges_by_position(const TriMesh& mesh, const std::stop_token& stop) {
  const std::vector<Triangle> welded = renumber(mesh.faces, weld(mesh.positions, stop));
  return build_halfedges(welded, mesh.vertex_count(), stop);
}

std::vector<double> seam_lengths(const Surface& surface, const UnwrappedSurface& unwrapped,
                                 const std::stop_token& stop) {
  return seam_lengths(surface.mesh, halfedges_by_position(surface.mesh, stop), unwrapped, stop);
}

std::vector<double> seam_lengths(const TriMesh& mesh, const Halfedges& by_position,
                                 const UnwrappedSurface& unwrapped, const std::stop_token& stop) {
  throw_if_cancelled(stop);
  const auto start = [&](Index h) -> const Vec3& {
    const Triangle& face = mesh.faces[static_cast<std::size_t>(face_of(h))];
    return mesh.positions[static_cast<std::size_t>(face[static_cast<std::size_t>(h % 3)])];
  };
  std::vector<double> length(mesh.faces.size(), 0);
  for (Index h = 0; h < static_cast<Index>(by_position.twin.size()); ++h) {
    check_cancelled_every(h, stop);
    const Index twin = by_position.twin[static_cast<std::size_t>(h)];
    if (twin != kNoTwin && is_seam(unwrapped, h, twin))
      length[static_cast<std::size_t>(face_of(h))] += (start(h) - start(twin)).norm();
  }
  return length;
}

double seam_length(const Surface& surface, const UnwrappedSurface& unwrapped) {
  const std::vector<double> by_face = seam_lengths(surface, unwrapped);
  return std::accumulate(by_face.begin(), by_face.end(), 0.0) / 2;
}

}  // namespace unwrapd::measure
