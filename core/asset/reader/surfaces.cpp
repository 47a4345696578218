// The triangles of a document become surfaces, one for each mesh. A geometry that several
// primitives share is read once, and a surface only has the vertices that its faces use, so that
// neither many primitives over one accessor nor many meshes over one buffer multiply the work.
#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>

#include "core/asset/base/as_size.hpp"
#include "core/asset/gltf/elements.hpp"
#include "core/asset/reader/steps.hpp"
#include "core/base/cancel.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::asset::reader {
namespace {

constexpr Index kUnused = -1;

/// Vertex numbers of a primitive, in the order of its mode.
std::vector<Index> read_corners(const Gltf& gltf, const Primitive& primitive) {
  const std::size_t vertex_count = gltf.accessors[primitive.position].count;
  const std::size_t count =
      primitive.indices ? gltf.accessors[*primitive.indices].count : vertex_count;
  std::vector<Index> corners(count);
  for (std::size_t i = 0; !primitive.indices && i < count; ++i) corners[i] = static_cast<Index>(i);
  if (!primitive.indices) return corners;
  const Elements indices(gltf, *primitive.indices);
  for (std::size_t i = 0; i < count; ++i) {
    check_cancelled_every(i, gltf.stop);
    const std::size_t index = indices.unsigned_at(i);
    if (index >= vertex_count)
      fail(ErrorCode::malformed_gltf, accessor_place(*primitive.indices),
           "index " + std::to_string(index) + " at position " + std::to_string(i) +
               " names no vertex: there are " + std::to_string(vertex_count) +
               "; export the asset again");
    corners[i] = static_cast<Index>(index);
  }
  return corners;
}

/// Strips and fans repeat a vertex to jump; such triangles are no faces. Lists keep all of theirs.
std::vector<Triangle> triangles_of(Mode mode, const std::vector<Index>& corners) {
  std::vector<Triangle> faces;
  const std::size_t n = corners.size();
  if (n < 3) return faces;
  faces.reserve(mode == Mode::triangles ? n / 3 : n - 2);
  if (mode == Mode::triangles) {
    for (std::size_t i = 0; i + 2 < n; i += 3)
      faces.push_back({corners[i], corners[i + 1], corners[i + 2]});
    return faces;
  }
  for (std::size_t i = 0; i + 2 < n; ++i) {
    const Triangle strip{corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]};
    const Triangle fan{corners[i + 1], corners[i + 2], corners[0]};
    const Triangle& face = mode == Mode::triangle_strip ? strip : fan;
    if (!repeats_vertex(face)) faces.push_back(face);
  }
  return faces;
}

/// Gathers the faces of a mesh, one primitive after another, over the vertices that they use.
class SurfaceBuilder {
 public:
  SurfaceBuilder(Gltf& gltf, const ReadLimits& limits) : gltf_(gltf), limits_(limits) {}

  /// Adds the primitive's faces, as one run.
  Piece add(const Primitive& primitive) {
    const std::vector<Triangle> faces =
        triangles_of(primitive.mode, read_corners(gltf_, primitive));
    if (faces.empty()) return {};
    if (surfaces_.empty() || mesh_ != primitive.mesh) start(primitive.mesh);
    add_vertices(primitive.position, faces);
    Surface& surface = surfaces_.back();
    const Piece piece{surfaces_.size() - 1, surface.mesh.faces.size(), faces.size()};
    const std::vector<Index>& number = numbers_[primitive.position];
    for (const Triangle& face : faces)
      surface.mesh.faces.push_back(
          {number[as_size(face[0])], number[as_size(face[1])], number[as_size(face[2])]});
    surface.part.resize(surface.mesh.faces.size(), static_cast<Index>(primitive.number));
    return piece;
  }

  std::vector<Surface> finish() { return std::move(surfaces_); }

 private:
  void start(std::size_t mesh) {
    for (const auto& [accessor, vertex] : touched_) numbers_[accessor][as_size(vertex)] = kUnused;
    touched_.clear();
    mesh_ = mesh;
    surfaces_.emplace_back().name = Place().at("meshes").at(mesh).pointer();
    gltf_.vertices.emplace_back();
  }

  /// Numbers the vertices of the faces that the surface does not have yet, in order.
  void add_vertices(std::size_t accessor, const std::vector<Triangle>& faces) {
    std::vector<Index>& number = numbers_[accessor];
    if (number.empty()) number.assign(gltf_.accessors[accessor].count, kUnused);
    const std::size_t first = touched_.size();
    for (const Triangle& face : faces)
      for (const Index vertex : face)
        if (Index& slot = number[as_size(vertex)]; slot == kUnused) {
          slot = 0;
          touched_.emplace_back(accessor, vertex);
        }
    std::sort(touched_.begin() + std::ptrdiff_t(first), touched_.end());
    const Elements& positions = elements_.try_emplace(accessor, gltf_, accessor).first->second;
    for (std::size_t i = first; i < touched_.size(); ++i) {
      check_cancelled_every(i, gltf_.stop);
      number[as_size(touched_[i].second)] = add_vertex(accessor, positions, touched_[i].second);
    }
  }

  Index add_vertex(std::size_t accessor, const Elements& positions, Index vertex) {
    if (++vertex_total_ > limits_.max_vertices)
      fail(ErrorCode::too_many_vertices, accessor_place(accessor),
           "the asset has more than " + std::to_string(limits_.max_vertices) +
               " vertices; simplify it or split it");
    const Vec3 position = positions.vec3_at(as_size(vertex));
    if (!position.allFinite())
      fail(ErrorCode::non_finite_position, accessor_place(accessor),
           "vertex " + std::to_string(vertex) +
               " is at an infinite or undefined position; repair the mesh");
    gltf_.vertices.back().push_back(vertex);
    surfaces_.back().mesh.positions.push_back(position);
    return surfaces_.back().mesh.vertex_count() - 1;
  }

  Gltf& gltf_;
  const ReadLimits& limits_;
  std::vector<Surface> surfaces_;
  std::size_t mesh_ = 0;
  std::int64_t vertex_total_ = 0;
  std::unordered_map<std::size_t, Elements> elements_;           ///< of position accessors
  std::unordered_map<std::size_t, std::vector<Index>> numbers_;  ///< [accessor][its vertex]
  std::vector<std::pair<std::size_t, Index>> touched_;           ///< entries that this mesh has set
};

/// Primitives with equal keys have the same triangles.
using GeometryKey = std::tuple<std::size_t, std::size_t, Mode>;

GeometryKey geometry_key(const Gltf& gltf, const Primitive& primitive) {
  return {primitive.position, primitive.indices.value_or(gltf.accessors.size()), primitive.mode};
}

}  // namespace

std::vector<Surface> build_surfaces(Gltf& gltf, const ReadLimits& limits) {
  SurfaceBuilder builder(gltf, limits);
  std::map<GeometryKey, std::size_t> known;
  for (Primitive& primitive : gltf.primitives) {
    if (!primitive.has_triangles) continue;
    const auto [found, is_new] =
        known.try_emplace(geometry_key(gltf, primitive), gltf.pieces.size());
    if (is_new) gltf.pieces.push_back(builder.add(primitive));
    primitive.piece = found->second;
    primitive.has_triangles = gltf.pieces[primitive.piece].face_count > 0;
  }
  std::vector<Surface> surfaces = builder.finish();
  if (surfaces.empty())
    throw Error(ErrorCode::no_triangles,
                "the asset has no triangles; send one with at least one triangle mesh");
  return surfaces;
}

}  // namespace unwrapd::asset::reader
