// A glTF vertex is a position, a UV and a normal together. An OBJ's corners combine them freely, so
// that each combination becomes a vertex.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <unordered_map>

#include "core/asset/as_size.hpp"
#include "core/asset/bytes.hpp"
#include "core/asset/convert.hpp"
#include "core/asset/grow.hpp"
#include "core/asset/patch.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset {
namespace {

using Float3 = std::array<float, 3>;

Float3 as_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

struct Vertices {
  std::vector<Float3> positions;
  std::vector<Float3> normals;  ///< empty unless every corner has one
  std::vector<std::array<float, 2>> uv;
  std::vector<Index> sources;                   ///< in the OBJ
  std::map<Index, std::vector<Index>> corners;  ///< [part]: three to a face
};

class Combiner {
 public:
  Combiner(const Obj& obj, const Surface& surface, const UnwrappedSurface& unwrapped)
      : obj_(obj), surface_(surface), unwrapped_(unwrapped), has_normals_(!obj.normals.empty()) {
    for (const ObjElement& element : obj.elements)
      for (std::size_t i = 0; element.face_count() > 0 && i < element.corner_count; ++i)
        has_normals_ &= obj.corners[element.first_corner + i].normal != kNoNormal;
  }

  Vertices run() {
    for (const ObjElement& element : obj_.elements)
      for (std::size_t t = element.first_face; t < element.first_face + element.face_count(); ++t) {
        check_cancelled_every(t, obj_.stop);
        for (std::size_t k = 0; k < 3; ++k)
          vertices_.corners[surface_.part[t]].push_back(
              number_of(unwrapped_.faces[t][k], normal_of(element, t, k)));
      }
    return std::move(vertices_);
  }

 private:
  [[nodiscard]] Index normal_of(const ObjElement& element, std::size_t t, std::size_t k) const {
    if (!has_normals_) return kNoNormal;
    return obj_.corners[element.first_corner + as_size(obj_.face_corners[t][k])].normal;
  }

  Index number_of(Index vertex, Index normal) {
    const std::uint64_t key = std::uint64_t(vertex) << 32 | static_cast<std::uint32_t>(normal);
    const auto [found, is_new] =
        numbers_.try_emplace(key, static_cast<Index>(vertices_.positions.size()));
    if (!is_new) return found->second;
    const Index source = unwrapped_.source[as_size(vertex)];
    vertices_.sources.push_back(source);
    vertices_.positions.push_back(as_floats(surface_.mesh.positions[as_size(source)]));
    const Vec2& uv = unwrapped_.uv[as_size(vertex)];
    vertices_.uv.push_back({static_cast<float>(uv.x()), static_cast<float>(1 - uv.y())});
    if (has_normals_) {
      const Vec3 unit = obj_.normals[as_size(normal)].stableNormalized();
      vertices_.normals.push_back(as_floats(unit.squaredNorm() > 0 ? unit : Vec3(0, 0, 1)));
    }
    return found->second;
  }

  const Obj& obj_;
  const Surface& surface_;
  const UnwrappedSurface& unwrapped_;
  bool has_normals_;
  Vertices vertices_;
  std::unordered_map<std::uint64_t, Index> numbers_;
};

std::string_view bytes_of(const std::vector<Float3>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Float3)};
}

Json vec3_accessor(const std::vector<Float3>& values, NewViews& views) {
  return {{"bufferView", views.add(bytes_of(values), 0, kArrayBufferTarget)},
          {"componentType", ComponentType::f32},
          {"count", values.size()},
          {"type", "VEC3"}};
}

}  // namespace

std::vector<Index> sources_in_gltf(const Obj& obj, const Surface& surface,
                                   const UnwrappedSurface& unwrapped) {
  return Combiner(obj, surface, unwrapped).run().sources;
}

std::string obj_as_gltf(const Obj& obj, const Surface& surface, const UnwrappedSurface& unwrapped,
                        Format output) {
  const Vertices vertices = Combiner(obj, surface, unwrapped).run();
  Gltf empty;
  empty.stop = obj.stop;
  PatchedDocument document{Json::parse(R"({
    "asset": {"version": "2.0", "generator": "unwrapd"},
    "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": []}], "accessors": [], "bufferViews": [], "buffers": []})"),
                           {}};
  NewViews views(document, 0);
  Json& accessors = document.json["accessors"];
  accessors.push_back(vec3_accessor(vertices.positions, views));
  set_bounds(accessors.back(), bytes_of(vertices.positions), sizeof(Float3), 3);
  accessors.push_back(texcoord_accessor(empty, std::nullopt, vertices.uv, views));
  Json attributes = {{"POSITION", 0}, {"TEXCOORD_0", 1}};
  if (!vertices.normals.empty()) {
    attributes["NORMAL"] = accessors.size();
    accessors.push_back(vec3_accessor(vertices.normals, views));
  }
  Json& primitives = document.json["meshes"][0]["primitives"];
  for (const auto& [part, corners] : vertices.corners) {
    primitives.push_back({{"attributes", attributes}, {"indices", accessors.size()}});
    accessors.push_back(index_accessor(empty, std::nullopt, corners, views));
  }
  return assemble(empty, std::move(document), output);
}

}  // namespace unwrapd::asset
