#include "core/solve/disk.hpp"

#include <cmath>

#include "core/cancel.hpp"
#include "core/error.hpp"

namespace unwrapd {

namespace {

/// In units of length, about the centroid.
std::vector<Vec3> normalised(std::span<const Vec3> positions, double unit,
                             const std::stop_token& stop) {
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& p : positions) centroid += p / static_cast<double>(positions.size());
  throw_if_cancelled(stop);
  std::vector<Vec3> moved;
  moved.reserve(positions.size());
  for (const Vec3& p : positions) moved.push_back((p - centroid) / unit);
  throw_if_cancelled(stop);
  return moved;
}

}  // namespace

Disk make_disk(const TriMesh& mesh, std::span<const BoundaryLoop> loops, Executor& executor) {
  const std::stop_token stop = executor.stop();
  throw_if_cancelled(stop);
  const double area = surface_area(mesh, executor);
  if (!(area > 0) || !std::isfinite(area))
    throw Error(ErrorCode::zero_area,
                "a part of the mesh has no area that double precision can hold; scale the mesh to "
                "ordinary units and try again");
  Disk disk{.faces = mesh.faces,
            .loops = loops,
            .positions = {},
            .rest = {},
            .corners = {},
            .unit = std::sqrt(area),
            .core = executor.shared_core(),
            .stop = stop};
  TriMesh scaled{normalised(mesh.positions, disk.unit, stop), mesh.faces};
  disk.rest = flatten(scaled, executor);
  disk.positions = std::move(scaled.positions);
  disk.corners = vertex_corners(mesh.faces, mesh.vertex_count(), stop);
  if (disk.core != nullptr) {
    disk.connectivity = disk.core->digest(Content("faces").add(disk.faces));
    disk.content = disk.core->digest(Content("disk").add(disk.connectivity).add(disk.positions));
  }
  return disk;
}

Disk make_disk(const TriMesh& mesh, std::span<const BoundaryLoop> loops,
               const std::stop_token& stop) {
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  return make_disk(mesh, loops, job);
}

}  // namespace unwrapd
