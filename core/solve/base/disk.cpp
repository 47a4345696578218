#include "core/solve/base/disk.hpp"

#include <cmath>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/base/cached.hpp"

namespace unwrapd::solve {

namespace {

/// Positions relative to the centroid, in multiples of unit.
std::vector<Vec3> normalise(std::span<const Vec3> positions, double unit,
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

std::vector<measure::RestTriangle> rest_of(const CacheContext& by,
                                           const SharedList<Vec3>& positions,
                                           ListView<Triangle> faces) {
  return measure::flatten(positions, faces, *by.executor);
}

linear::VertexCorners corners_of(const CacheContext& by, ListView<Triangle> faces,
                                 Index vertex_count) {
  return linear::vertex_corners(faces, vertex_count, by.stop);
}

/// Stores digests of the long lists, so that keys need not read them again: faces and positions by
/// their bytes, lists that follow from them by the same digests.
void tell_digests(const SharedCache& core, Disk& disk) {
  disk.faces = known_by_bytes(&core, disk.faces);
  disk.positions = known_by_bytes(&core, disk.positions);
  disk.rest = disk.rest.known_as(key_of<rest_of>(core, disk.positions, disk.faces));
  const Digest corners = key_of<corners_of>(core, disk.faces, disk.vertex_count());
  disk.corners = {disk.corners.begin.known_as(corners), disk.corners.corner.known_as(corners)};
}

}  // namespace

void describe(CacheKey& key, const Disk& disk) {
  const auto& [faces, loops, positions, rest, corners, unit, core, twin, is_ordered, stop] = disk;
  static_cast<void>(core), static_cast<void>(stop);
  key.add(faces).add(loops).add(positions).add(rest).add(corners.begin).add(corners.corner);
  key.add(unit).add(twin).add(is_ordered);
}

Disk make_disk(const TriMesh& mesh, std::span<const BoundaryLoop> loops, Executor& executor) {
  const std::stop_token stop = executor.stop();
  throw_if_cancelled(stop);
  const double area = measure::surface_area(mesh, executor);
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
            .core = executor.shared_cache(),
            .stop = stop};
  const CacheContext by{disk.core, stop, &executor};
  disk.positions = normalise(mesh.positions, disk.unit, stop);
  disk.rest = rest_of(by, disk.positions, disk.faces);
  disk.corners = corners_of(by, disk.faces, disk.vertex_count());
  if (disk.core != nullptr) tell_digests(*disk.core, disk);
  return disk;
}

Disk make_disk(const TriMesh& mesh, std::span<const BoundaryLoop> loops,
               const std::stop_token& stop) {
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  return make_disk(mesh, loops, job);
}

UvMap with_unit_area(const Disk& disk, UvMap uv, Executor& executor) {
  const double area = measure::uv_area(disk.rest, disk.faces, uv, executor);
  if (area > 0)
    for (Vec2& u : uv) u /= std::sqrt(area);
  return uv;
}

UvMap with_unit_area(const Disk& disk, UvMap uv) {
  SerialExecutor serial;
  return with_unit_area(disk, std::move(uv), serial);
}

}  // namespace unwrapd::solve
