// Degenerate and duplicate faces.
//
// A face is flat if its height over its longest edge is below the precision of its coordinates.
// Coordinates are rounded to half a unit in the last place, 2^-53 of their size, so that three
// points of one line end up a few such units off it. The bound is 2^-50 of the largest coordinate
// (and of the longest edge): it scales and moves with the mesh, and a sliver of any real height,
// say 1e-12 of its length, is not flat. A face shorter than 2^-300 of the mesh's extent is also
// flat: its area underflows.
#include "core/mesh/repair.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>

#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd {
namespace {

constexpr double kRounding = 0x1p-50;
constexpr double kLeastLength =
    0x1p-300;  // of a face, relative to the largest coordinate of the mesh

double greatest(const Vec3& v) { return v.lpNorm<Eigen::Infinity>(); }

bool is_flat(const Vec3& a, const Vec3& b, const Vec3& c, double least_length) {
  const Vec3 ab = b - a, ac = c - a;
  const double length = std::max({greatest(ab), greatest(ac), greatest(c - b)});
  const double reach = std::max({greatest(a), greatest(b), greatest(c)}) + length;
  const double relative_height = (ab / length).cross(ac / length).norm();
  return !(relative_height * length > kRounding * reach && length > least_length);
}

struct Corners {
  Triangle vertex;  ///< the lowest first
  Index face = 0;
};

std::vector<Corners> sorted_corners(std::span<const Triangle> faces, const FaceStates& states,
                                    Index vertex_count, const std::stop_token& stop) {
  std::vector<Corners> list;
  list.reserve(faces.size());
  for (std::size_t t = 0; t < faces.size(); ++t) {
    check_cancelled_every(t, stop);
    if (states.of[t] != FaceState::sound) continue;
    Triangle face = faces[t];
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    list.push_back({face, static_cast<Index>(t)});
  }
  for (int corner : {2, 1, 0})
    counting_sort(
        list, vertex_count, [corner](const Corners& c) { return c.vertex[corner]; }, stop);
  return list;
}

}  // namespace

FaceStates inspect_areas(const TriMesh& mesh, std::span<const Triangle> welded,
                         const std::stop_token& stop) {
  FaceStates states{std::vector<FaceState>(welded.size(), FaceState::sound),
                    std::vector<Index>(welded.size(), kNoFace)};
  double most = 0;
  for (const Vec3& position : mesh.positions) most = std::max(most, greatest(position));
  for (std::size_t t = 0; t < welded.size(); ++t) {
    check_cancelled_every(t, stop);
    const auto& [a, b, c] = welded[t];
    if (repeats_vertex(welded[t]))
      states.of[t] = FaceState::collapsed;
    else if (is_flat(mesh.positions[a], mesh.positions[b], mesh.positions[c], kLeastLength * most))
      states.of[t] = FaceState::flat;
  }
  return states;
}

void find_duplicates(std::span<const Triangle> welded, Index vertex_count,
                     const std::stop_token& stop, FaceStates& states) {
  for_each_run(
      sorted_corners(welded, states, vertex_count, stop),
      [](const Corners& a, const Corners& b) { return a.vertex == b.vertex; },
      [&](const Corners* first, const Corners* last) {
        for (const Corners* c = first + 1; c < last; ++c) {
          states.of[c->face] = FaceState::duplicate;
          states.same_as[c->face] = first->face;
        }
      },
      stop);
}

FaceStates inspect_faces(const TriMesh& mesh, std::span<const Triangle> welded,
                         const std::stop_token& stop) {
  FaceStates states = inspect_areas(mesh, welded, stop);
  find_duplicates(welded, mesh.vertex_count(), stop, states);
  return states;
}

}  // namespace unwrapd
