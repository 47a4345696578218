#include "core/asset/writer/cut.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>
#include <utility>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/pace.hpp"
#include "core/asset/gltf/elements.hpp"

namespace unwrapd::asset::writer {
namespace {

std::optional<std::size_t> normals_of(const Primitive& primitive) {
  for (const auto& [semantic, accessor] : primitive.attributes)
    if (semantic == "NORMAL") return accessor;
  return std::nullopt;
}

/// The pool's vertices and faces after the cut, and new tangents for them. A vertex whose corners
/// have different tangents gets copies, for example between mirrored halves without a seam.
class TangentMaker {
 public:
  TangentMaker(const Gltf& gltf, const Primitive& primitive, Split& split)
      : gltf_(gltf), split_(split), pace_(gltf.stop) {
    first_copy_ = gltf.accessors[primitive.position].count;
    for (auto& [piece, corners] : split.corners)
      for (std::size_t c = 0; c + 2 < corners.size(); c += 3)
        mesh_.faces.push_back({corners[c], corners[c + 1], corners[c + 2]});
    take_vertices(primitive);
  }

  std::vector<Tangent> run() {
    const std::vector<std::array<Tangent, 3>> of_corner = corner_tangents(mesh_, gltf_.stop);
    for (const Vec3& normal : mesh_.normals) tangents_.push_back(any_tangent(normal));
    has_tangent_.assign(tangents_.size(), 0);
    next_.assign(tangents_.size(), kNone);
    std::size_t face = 0;
    for (auto& [piece, corners] : split_.corners)
      for (std::size_t c = 0; c + 2 < corners.size(); c += 3, ++face)
        for (std::size_t k = 0; k < 3; ++k) {
          pace_.add(2);
          const Index vertex = with_tangent(corners[c + k], of_corner[face][k]);
          if (vertex != corners[c + k]) split_.changed.insert(piece);
          corners[c + k] = vertex;
        }
    return std::move(tangents_);
  }

 private:
  static constexpr Index kNone = -1;

  void take_vertices(const Primitive& primitive) {
    const Elements positions(gltf_, primitive.position);
    const std::optional<std::size_t> accessor = normals_of(primitive);
    std::optional<Elements> normals;
    if (accessor && gltf_.accessors[*accessor].components == 3) normals.emplace(gltf_, *accessor);
    for (std::size_t v = 0; v < split_.uv.size(); ++v) {
      pace_.add(4);
      const std::size_t source = v < first_copy_ ? v : as_size(split_.copies[v - first_copy_]);
      mesh_.positions.push_back(positions.vec3_at(source));
      mesh_.normals.push_back(normals ? normals->vec3_at(source) : Vec3::Zero());
      mesh_.uv.emplace_back(split_.uv[v][0], 1 - split_.uv[v][1]);
    }
    if (!normals) add_face_normals();
    for (Vec3& normal : mesh_.normals)
      normal = normal.allFinite() ? normal.stableNormalized().eval() : Vec3::Zero().eval();
  }

  /// Sets the area-weighted normals of the triangles, for a primitive without normals.
  void add_face_normals() {
    for (const Triangle& face : mesh_.faces) {
      const Vec3& p = mesh_.positions[as_size(face[0])];
      const Vec3 normal =
          (mesh_.positions[as_size(face[1])] - p).cross(mesh_.positions[as_size(face[2])] - p);
      for (const Index vertex : face) mesh_.normals[as_size(vertex)] += normal;
    }
  }

  /// The vertex, or its copy, with this tangent; a new copy if there is none.
  Index with_tangent(Index vertex, const Tangent& tangent) {
    while (has_tangent_[as_size(vertex)] != 0 && tangents_[as_size(vertex)] != tangent) {
      if (next_[as_size(vertex)] == kNone) next_[as_size(vertex)] = copy_of(vertex);
      vertex = next_[as_size(vertex)];
    }
    has_tangent_[as_size(vertex)] = 1;
    tangents_[as_size(vertex)] = tangent;
    return vertex;
  }

  Index copy_of(Index vertex) {
    const std::size_t v = as_size(vertex);
    split_.copies.push_back(v < first_copy_ ? vertex : split_.copies[v - first_copy_]);
    split_.uv.push_back(split_.uv[v]);
    tangents_.push_back(tangents_[v]);
    has_tangent_.push_back(0);
    next_.push_back(kNone);
    return static_cast<Index>(tangents_.size() - 1);
  }

  const Gltf& gltf_;
  Split& split_;
  Pace pace_;
  std::size_t first_copy_ = 0;
  TangentMesh mesh_;
  std::vector<Tangent> tangents_;
  std::vector<char> has_tangent_;
  std::vector<Index> next_;  ///< [vertex]: a copy of it with another tangent
};

}  // namespace

std::vector<Pool> pools_of(const Gltf& gltf) {
  std::vector<Pool> pools(gltf.pool_count);
  std::set<std::pair<std::size_t, std::size_t>> seen;
  for (std::size_t i = 0; i < gltf.primitives.size(); ++i) {
    const Primitive& primitive = gltf.primitives[i];
    if (!primitive.has_triangles) continue;
    Pool& pool = pools[primitive.pool];
    pool.primitives.push_back(i);
    if (seen.emplace(primitive.pool, primitive.piece).second)
      pool.pieces.push_back(primitive.piece);
  }
  std::erase_if(pools, [](const Pool& pool) { return pool.primitives.empty(); });
  return pools;
}

Cut Cutter::cut(const Pool& pool) {
  const auto loser = std::find_if(pool.primitives.begin(), pool.primitives.end(), [&](auto i) {
    return materials_.loses_tangents(gltf_.primitives[i]);
  });
  const Primitive& first = gltf_.primitives[pool.primitives.front()];
  const bool is_any = loser != pool.primitives.end();
  Cut cut;
  cut.split = splitter_.split(pool.pieces, gltf_.accessors[first.position].count, is_any);
  if (is_any) cut.tangents = TangentMaker(gltf_, gltf_.primitives[*loser], cut.split).run();
  return cut;
}

}  // namespace unwrapd::asset::writer
