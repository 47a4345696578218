#include "core/segment/mirror.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/point_tree.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kMostToothed = 1.5;  // times as long as the same without teeth

Vec3 middle_of(const TriMesh& mesh, const Triangle& face) {
  return (mesh.positions[face[0]] + mesh.positions[face[1]] + mesh.positions[face[2]]) / 3;
}

/// The centre of the surface's area, and the directions across which a plane may lie.
struct Directions {
  Vec3 centre = Vec3::Zero();
  std::vector<Vec3> normals{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};

  explicit Directions(const TriMesh& mesh) {
    double area = 0;
    for (const Triangle& face : mesh.faces) {
      const double own = measure::face_area(mesh, face);
      centre += own * middle_of(mesh, face);
      area += own;
    }
    centre /= area;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Triangle& face : mesh.faces) {
      const Vec3 arm = middle_of(mesh, face) - centre;
      spread += measure::face_area(mesh, face) * arm * arm.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
    for (int k = 0; k < 3; ++k) normals.emplace_back(axes.eigenvectors().col(k));
  }
};

/// The images of vertices, -1 for one that has none; nothing if too few have one.
std::optional<std::vector<Index>> vertex_images(const TriMesh& mesh, const PointTree& tree,
                                                const Mirror& mirror) {
  const std::size_t count = mesh.positions.size();
  const auto most_lost = static_cast<std::size_t>((1 - kLeastMirrored) * double(count));
  std::vector<Index> image(count, -1);
  std::size_t lost = 0;
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3 place = mirror.reflected(mesh.positions[v]);
    const Index nearest = *tree.nearest(place);
    if ((mesh.positions[nearest] - place).norm() <= kMirrorTolerance)
      image[v] = nearest;
    else if (++lost > most_lost)
      return std::nullopt;
  }
  for (std::size_t v = 0; v < count; ++v)
    if (image[v] >= 0 && image[image[v]] != static_cast<Index>(v)) image[v] = -1, ++lost;
  if (lost > most_lost) return std::nullopt;
  return image;
}

/// Half-edges by their ends.
class HalfedgeFinder {
 public:
  explicit HalfedgeFinder(const TriMesh& mesh) {
    for (Index h = 0; h < 3 * mesh.face_count(); ++h)
      ends_.push_back({start_of(mesh.faces, h), end_of(mesh.faces, h), h});
    std::ranges::sort(ends_);
  }

  [[nodiscard]] Index find(Index start, Index end) const {
    const auto at = std::ranges::lower_bound(ends_, std::array<Index, 3>{start, end, 0});
    return at != ends_.end() && (*at)[0] == start && (*at)[1] == end ? (*at)[2] : -1;
  }

 private:
  std::vector<std::array<Index, 3>> ends_;
};

std::vector<Index> halfedge_images(const TriMesh& mesh, const std::vector<Index>& vertex) {
  const HalfedgeFinder finder(mesh);
  std::vector<Index> image;
  for (Index h = 0; h < 3 * mesh.face_count(); ++h) {
    const Index start = vertex[end_of(mesh.faces, h)], end = vertex[start_of(mesh.faces, h)];
    image.push_back(start >= 0 && end >= 0 ? finder.find(start, end) : -1);
  }
  return image;
}

/// The face in front whose image a face is; where there is none, the one at the nearest place.
void find_sources(const TriMesh& mesh, Mirror& mirror) {
  std::vector<Vec3> middles;
  std::vector<Index> front;
  for (Index t = 0; t < mesh.face_count(); ++t) {
    middles.push_back(middle_of(mesh, mesh.faces[t]));
    if (mirror.is_front[t] != 0) front.push_back(t);
  }
  const PointTree tree(middles, std::move(front));
  for (Index t = 0; t < mesh.face_count(); ++t) {
    const std::span<const Index> own(&mirror.halfedge[3 * t], 3);
    const bool is_image =
        own[0] >= 0 && own[1] >= 0 && own[2] >= 0 && face_of(own[0]) == face_of(own[1]) &&
        face_of(own[0]) == face_of(own[2]) && mirror.is_front[face_of(own[0])] != 0;
    if (mirror.is_front[t] != 0)
      mirror.source.push_back(-1);
    else
      mirror.source.push_back(is_image ? face_of(own[0])
                                       : *tree.nearest(mirror.reflected(middles[t])));
  }
}

/// Whether the border between front and back runs to and fro across the plane, as between the long
/// triangles of a tube's wall halfway up: charts that end there would have teeth.
bool is_toothed(const TriMesh& mesh, const Halfedges& halfedges, const Mirror& mirror) {
  double length = 0, along_plane = 0;
  for (Index h = 0; h < 3 * mesh.face_count(); ++h) {
    const Index twin = halfedges.twin[h];
    if (twin == kNoTwin || mirror.is_front[face_of(h)] == mirror.is_front[face_of(twin)]) continue;
    const Vec3 side =
        mesh.positions[end_of(mesh.faces, h)] - mesh.positions[start_of(mesh.faces, h)];
    length += side.norm();
    along_plane += (side - mirror.normal.dot(side) * mirror.normal).norm();
  }
  return length > kMostToothed * along_plane;
}

}  // namespace

std::optional<Mirror> find_mirror(const TriMesh& mesh, const Halfedges& halfedges,
                                  const std::stop_token& stop) {
  const Directions directions(mesh);
  std::vector<Index> all(mesh.positions.size());
  std::iota(all.begin(), all.end(), 0);
  const PointTree tree(mesh.positions, std::move(all));
  for (const Vec3& normal : directions.normals) {
    throw_if_cancelled(stop);
    Mirror mirror{.centre = directions.centre,
                  .normal = normal,
                  .is_front = {},
                  .halfedge = {},
                  .source = {}};
    for (const Triangle& face : mesh.faces)
      mirror.is_front.push_back(normal.dot(middle_of(mesh, face) - mirror.centre) > 0 ? 1 : 0);
    const auto front = std::ranges::count(mirror.is_front, 1);
    if (front == 0 || front == mesh.face_count()) continue;
    const auto vertex = vertex_images(mesh, tree, mirror);
    if (!vertex || is_toothed(mesh, halfedges, mirror)) continue;
    mirror.halfedge = halfedge_images(mesh, *vertex);
    find_sources(mesh, mirror);
    return mirror;
  }
  return std::nullopt;
}

std::array<Vec2, 3> reflected_map(const Mirror& mirror, const TriMesh& mesh,
                                  const std::array<Index, 2>& front_and_behind,
                                  const std::array<Vec2, 3>& uv) {
  const auto at = [&](std::size_t which, std::size_t i) -> const Vec3& {
    return mesh.positions[mesh.faces[front_and_behind[which]][i]];
  };
  const Vec3 origin = at(0, 0), x = at(0, 1) - origin, y = at(0, 2) - origin;
  const double xx = x.dot(x), xy = x.dot(y), yy = y.dot(y);
  const double determinant = std::max(xx * yy - xy * xy, std::numeric_limits<double>::min());
  std::array<Vec2, 3> own;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 p = mirror.reflected(at(1, i)) - origin;
    const double a = (yy * p.dot(x) - xy * p.dot(y)) / determinant;
    const double b = (xx * p.dot(y) - xy * p.dot(x)) / determinant;
    const Vec2 u = uv[0] + a * (uv[1] - uv[0]) + b * (uv[2] - uv[0]);
    own[i] = {-u.x(), u.y()};
  }
  return own;
}

}  // namespace unwrapd::segment
