#include "core/asset/writer/tangent_space.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <unordered_map>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/pace.hpp"

namespace unwrapd::asset::writer {
namespace {

constexpr Index kNoIndex = -1;

/// Position, normal and texture coordinates of a vertex.
using VertexKey = std::array<double, 8>;

struct VertexHash {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t hash = 0;
    for (const double value : key)
      hash = (hash ^ std::hash<double>()(value)) * 0x9e3779b97f4a7c15U + (hash >> 29U);
    return hash;
  }
};

/// [vertex]: the first vertex that equals it.
std::vector<Index> welded(const TangentMesh& mesh, Pace& pace) {
  std::unordered_map<VertexKey, Index, VertexHash> first;
  std::vector<Index> number(mesh.positions.size());
  for (std::size_t v = 0; v < number.size(); ++v) {
    pace.add(8);
    const Vec3 &p = mesh.positions[v], &n = mesh.normals[v];
    const VertexKey key{p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), mesh.uv[v].x(), mesh.uv[v].y()};
    number[v] = first.try_emplace(key, static_cast<Index>(v)).first->second;
  }
  return number;
}

/// The derivative of a triangle's position by texture coordinates.
struct FaceTangent {
  Vec3 along_u = Vec3::Zero();  ///< of unit length
  bool is_mirrored = false;
  bool is_defined = false;  ///< its texture coordinates span an area, and it has three corners
};

/// Mikkelsen, section 2.2: dP/du = (v31 P21 - v21 P31) / (u21 v31 - v21 u31).
FaceTangent face_tangent(const TangentMesh& mesh, const Triangle& face) {
  const auto position = [&](int k) { return mesh.positions[as_size(face[k])]; };
  const auto uv = [&](int k) { return mesh.uv[as_size(face[k])]; };
  const Vec2 t21 = uv(1) - uv(0), t31 = uv(2) - uv(0);
  const double area = t21.x() * t31.y() - t21.y() * t31.x();
  FaceTangent tangent;
  tangent.is_mirrored = area < 0;
  const Vec3 scaled = t31.y() * (position(1) - position(0)) - t21.y() * (position(2) - position(0));
  tangent.along_u = (tangent.is_mirrored ? -scaled : scaled).stableNormalized();
  const bool has_corners =
      position(0) != position(1) && position(1) != position(2) && position(2) != position(0);
  tangent.is_defined = area != 0 && has_corners && tangent.along_u.squaredNorm() > 0;
  return tangent;
}

Vec3 in_plane(const Vec3& vector, const Vec3& normal) {
  return (vector - normal * normal.dot(vector)).stableNormalized();
}

class TangentSpace {
 public:
  TangentSpace(const TangentMesh& mesh, const std::stop_token& stop)
      : mesh_(mesh), pace_(stop), welded_(welded(mesh, pace_)), group_(mesh.faces.size()) {
    faces_.reserve(mesh.faces.size());
    for (const Triangle& face : mesh.faces) {
      pace_.add(4);
      faces_.push_back(face_tangent(mesh, face));
    }
    for (std::array<Index, 3>& groups : group_) groups.fill(kNoIndex);
    join_edges();
  }

  std::vector<std::array<Tangent, 3>> run() {
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (int k = 0; k < 3; ++k)
        if (faces_[f].is_defined && group_[f][k] == kNoIndex) gather(f, k);
    std::vector<std::array<Tangent, 3>> tangents(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (int k = 0; k < 3; ++k) tangents[f][k] = tangent_at(f, k);
    return tangents;
  }

 private:
  struct Corner {
    Index face = kNoIndex;
    int corner = 0;
  };

  [[nodiscard]] Index vertex(std::size_t face, int corner) const {
    return welded_[as_size(mesh_.faces[face][corner])];
  }

  /// Two triangles with an edge in opposite directions are neighbours; each edge has one neighbour.
  void join_edges() {
    neighbours_.assign(faces_.size(), {kNoIndex, kNoIndex, kNoIndex});
    std::unordered_map<std::uint64_t, std::vector<Corner>> open;  // [from, to]
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        pace_.add(8);
        const auto from = std::uint64_t(vertex(f, k)), to = std::uint64_t(vertex(f, (k + 1) % 3));
        const auto other = open.find(to << 32U | from);
        if (other == open.end() || other->second.empty()) {
          open[from << 32U | to].push_back({static_cast<Index>(f), k});
          continue;
        }
        const Corner back = other->second.back();
        other->second.pop_back();
        neighbours_[f][k] = back.face;
        neighbours_[as_size(back.face)][back.corner] = static_cast<Index>(f);
      }
  }

  /// Collects the triangles around a vertex, across edges without a mirror between them.
  void gather(std::size_t face, int corner) {
    const auto group = static_cast<Index>(groups_.size());
    const Index center = vertex(face, corner);
    const bool is_mirrored = faces_[face].is_mirrored;
    Vec3 sum = Vec3::Zero();
    std::vector<std::size_t> waiting = {face};
    while (!waiting.empty()) {
      const std::size_t f = waiting.back();
      waiting.pop_back();
      pace_.add(8);
      const int k = corner_of(f, center);
      const bool fits = !faces_[f].is_defined || faces_[f].is_mirrored == is_mirrored;
      if (!fits || k < 0 || group_[f][k] != kNoIndex) continue;
      group_[f][k] = group;
      if (faces_[f].is_defined) sum += weighted(f, k);
      for (const Index next : {neighbours_[f][k], neighbours_[f][(k + 2) % 3]})
        if (next != kNoIndex) waiting.push_back(as_size(next));
    }
    groups_.push_back(made(sum, mesh_.normals[as_size(center)], is_mirrored));
  }

  [[nodiscard]] int corner_of(std::size_t face, Index center) const {
    for (int k = 0; k < 3; ++k)
      if (vertex(face, k) == center) return k;
    return -1;
  }

  /// The triangle's tangent in the plane of the corner's normal, by its angle there.
  [[nodiscard]] Vec3 weighted(std::size_t face, int corner) const {
    const Triangle& t = mesh_.faces[face];
    const Vec3& normal = mesh_.normals[as_size(t[corner])];
    const Vec3& p = mesh_.positions[as_size(t[corner])];
    const Vec3 a = in_plane(mesh_.positions[as_size(t[(corner + 1) % 3])] - p, normal);
    const Vec3 b = in_plane(mesh_.positions[as_size(t[(corner + 2) % 3])] - p, normal);
    return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * in_plane(faces_[face].along_u, normal);
  }

  static Tangent made(const Vec3& sum, const Vec3& normal, bool is_mirrored) {
    const Vec3 unit = in_plane(sum, normal);
    Tangent tangent = any_tangent(normal);
    if (unit.squaredNorm() > 0.5)
      for (int k = 0; k < 3; ++k)
        tangent[static_cast<std::size_t>(k)] = static_cast<float>(unit[k]);
    tangent[3] = is_mirrored ? -1.0F : 1.0F;
    return tangent;
  }

  [[nodiscard]] Tangent tangent_at(std::size_t face, int corner) const {
    const Index group = group_[face][corner];
    return group != kNoIndex ? groups_[as_size(group)]
                             : any_tangent(mesh_.normals[as_size(mesh_.faces[face][corner])]);
  }

  const TangentMesh& mesh_;
  Pace pace_;
  std::vector<Index> welded_;
  std::vector<FaceTangent> faces_;
  std::vector<Triangle> neighbours_;         ///< [face][edge from that corner on]
  std::vector<std::array<Index, 3>> group_;  ///< [face][corner]
  std::vector<Tangent> groups_;
};

}  // namespace

std::vector<std::array<Tangent, 3>> corner_tangents(const TangentMesh& mesh,
                                                    const std::stop_token& stop) {
  return TangentSpace(mesh, stop).run();
}

Tangent any_tangent(const Vec3& normal) {
  const Vec3 unit = normal.squaredNorm() > 0 ? normal.unitOrthogonal() : Vec3(1, 0, 0);
  return {static_cast<float>(unit.x()), static_cast<float>(unit.y()), static_cast<float>(unit.z()),
          1.0F};
}

}  // namespace unwrapd::asset::writer
