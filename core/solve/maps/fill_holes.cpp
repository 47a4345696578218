#include "core/solve/maps/fill_holes.hpp"

#include <utility>

#include "core/base/cancel.hpp"
#include "core/mesh/edges.hpp"
#include "core/solve/maps/lay_out.hpp"

namespace unwrapd::solve::maps {
namespace {

measure::RestTriangle triangle_of(std::span<const Vec3> positions, const Triangle& face) {
  std::array<double, 3> length{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto a = static_cast<std::size_t>(face[i]);
    const auto b = static_cast<std::size_t>(face[(i + 1) % 3]);
    length[i] = (positions[a] - positions[b]).norm();
  }
  return triangle_of_lengths(length);
}

/// The lists that the fans are appended to.
struct Lists {
  std::vector<Vec3> positions;
  std::vector<measure::RestTriangle> rest;
};

void close(const BoundaryLoop& loop, Lists& lists, std::vector<Triangle>& faces) {
  Vec3 centre = Vec3::Zero();
  for (Index h : loop) centre += lists.positions[static_cast<std::size_t>(start_of(faces, h))];
  const auto hub = static_cast<Index>(lists.positions.size());
  lists.positions.emplace_back(centre / static_cast<double>(loop.size()));
  for (Index h : loop) {
    faces.push_back({end_of(faces, h), start_of(faces, h), hub});
    lists.rest.push_back(triangle_of(lists.positions, faces.back()));
  }
}

}  // namespace

FilledDisk fill_holes(const Disk& disk) {
  FilledDisk filled;
  filled.faces.assign(disk.faces.begin(), disk.faces.end());
  filled.loops = {disk.loops.front()};
  throw_if_cancelled(disk.stop);
  Lists lists{{disk.positions.begin(), disk.positions.end()}, {disk.rest.begin(), disk.rest.end()}};
  throw_if_cancelled(disk.stop);
  for (const BoundaryLoop& loop : disk.loops.subspan(1)) close(loop, lists, filled.faces);
  filled.disk.positions = std::move(lists.positions);
  filled.disk.rest = std::move(lists.rest);
  filled.disk.unit = disk.unit;
  filled.disk.stop = disk.stop;
  filled.disk.faces = filled.faces;
  filled.disk.loops = filled.loops;
  filled.disk.corners = linear::vertex_corners(filled.faces, filled.disk.vertex_count(), disk.stop);
  return filled;
}

}  // namespace unwrapd::solve::maps
