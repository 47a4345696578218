#include "core/solve/fill_holes.hpp"

#include "core/cancel.hpp"
#include "core/mesh/edges.hpp"
#include "core/solve/lay_out.hpp"

namespace unwrapd {
namespace {

RestTriangle triangle_of(const Disk& disk, const Triangle& face) {
  std::array<double, 3> length{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto a = static_cast<std::size_t>(face[i]);
    const auto b = static_cast<std::size_t>(face[(i + 1) % 3]);
    length[i] = (disk.positions[a] - disk.positions[b]).norm();
  }
  return triangle_of_lengths(length);
}

void close(FilledDisk& filled, const BoundaryLoop& loop) {
  Disk& disk = filled.disk;
  Vec3 centre = Vec3::Zero();
  for (Index h : loop)
    centre += disk.positions[static_cast<std::size_t>(start_of(filled.faces, h))];
  const Index hub = disk.vertex_count();
  disk.positions.emplace_back(centre / static_cast<double>(loop.size()));
  for (Index h : loop) {
    filled.faces.push_back({end_of(filled.faces, h), start_of(filled.faces, h), hub});
    disk.rest.push_back(triangle_of(disk, filled.faces.back()));
  }
}

}  // namespace

FilledDisk fill_holes(const Disk& disk) {
  FilledDisk filled;
  filled.faces.assign(disk.faces.begin(), disk.faces.end());
  filled.loops = {disk.loops.front()};
  filled.disk.positions = disk.positions;
  filled.disk.stop = disk.stop;
  throw_if_cancelled(disk.stop);
  filled.disk.rest = disk.rest;
  throw_if_cancelled(disk.stop);
  filled.disk.unit = disk.unit;
  for (const BoundaryLoop& loop : disk.loops.subspan(1)) close(filled, loop);
  filled.disk.faces = filled.faces;
  filled.disk.loops = filled.loops;
  filled.disk.corners = vertex_corners(filled.faces, filled.disk.vertex_count(), disk.stop);
  return filled;
}

}  // namespace unwrapd
