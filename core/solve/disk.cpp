#include "core/solve/disk.hpp"

#include <cmath>

#include "core/cancel.hpp"
#include "core/error.hpp"

namespace unwrapd {

Disk make_disk(const TriMesh& mesh, std::span<const BoundaryLoop> loops, SolverCore* core,
               const std::stop_token& stop) {
  throw_if_cancelled(stop);
  const double area = surface_area(mesh);
  if (!(area > 0) || !std::isfinite(area))
    throw Error(ErrorCode::zero_area,
                "a part of the mesh has no area that double precision can hold; scale the mesh to "
                "ordinary units and try again");
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& p : mesh.positions) centroid += p / static_cast<double>(mesh.vertex_count());
  throw_if_cancelled(stop);

  Disk disk{.faces = mesh.faces,
            .loops = loops,
            .positions = {},
            .rest = {},
            .corners = {},
            .unit = std::sqrt(area),
            .core = core,
            .stop = stop};
  TriMesh scaled{{}, mesh.faces};
  scaled.positions.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) scaled.positions.push_back((p - centroid) / disk.unit);
  throw_if_cancelled(stop);
  disk.rest = flatten(scaled, stop);
  disk.positions = std::move(scaled.positions);
  disk.corners = vertex_corners(mesh.faces, mesh.vertex_count(), stop);
  if (core != nullptr) {
    disk.connectivity = core->digest(Content("faces").add(disk.faces));
    disk.content = core->digest(Content("disk").add(disk.connectivity).add(disk.positions));
  }
  return disk;
}

}  // namespace unwrapd
