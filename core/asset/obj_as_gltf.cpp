// A glTF vertex is a position, a UV and a normal together. The corners of an OBJ combine them
// freely, so that each combination becomes a vertex.
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

/// What the corners of a surface are made of, whatever format it came in.
struct Parts {
  const Surface& surface;
  const UnwrappedSurface& unwrapped;
  std::span<const Vec3> normals;  ///< empty unless every corner has one
};

class Combiner {
 public:
  explicit Combiner(const Parts& parts) : parts_(parts) {}

  /// Corner k of face t. normal: in parts.normals, or kNoNormal.
  void add(std::size_t t, std::size_t k, Index normal) {
    vertices_.corners[parts_.surface.part[t]].push_back(
        number_of(parts_.unwrapped.faces[t][k], normal));
  }

  Vertices take() { return std::move(vertices_); }

 private:
  Index number_of(Index vertex, Index normal) {
    const std::uint64_t key = std::uint64_t(vertex) << 32 | static_cast<std::uint32_t>(normal);
    const auto [found, is_new] =
        numbers_.try_emplace(key, static_cast<Index>(vertices_.positions.size()));
    if (!is_new) return found->second;
    const Index source = parts_.unwrapped.source[as_size(vertex)];
    vertices_.sources.push_back(source);
    vertices_.positions.push_back(as_floats(parts_.surface.mesh.positions[as_size(source)]));
    const Vec2& uv = parts_.unwrapped.uv[as_size(vertex)];
    vertices_.uv.push_back({static_cast<float>(uv.x()), static_cast<float>(1 - uv.y())});
    if (normal != kNoNormal) {
      const Vec3 unit = parts_.normals[as_size(normal)].stableNormalized();
      vertices_.normals.push_back(as_floats(unit.squaredNorm() > 0 ? unit : Vec3(0, 0, 1)));
    }
    return found->second;
  }

  Parts parts_;
  Vertices vertices_;
  std::unordered_map<std::uint64_t, Index> numbers_;
};

bool has_all_normals(const Obj& obj) {
  return !obj.normals.empty() && std::ranges::all_of(obj.elements, [&](const ObjElement& element) {
    const auto corners = std::span(obj.corners).subspan(element.first_corner, element.corner_count);
    return element.face_count() == 0 ||
           std::ranges::all_of(corners, [](const ObjCorner& c) { return c.normal != kNoNormal; });
  });
}

Vertices vertices_of(const Obj& obj, const Surface& surface, const UnwrappedSurface& unwrapped) {
  const bool has_normals = has_all_normals(obj);
  Combiner combiner({surface, unwrapped, obj.normals});
  for (const ObjElement& element : obj.elements)
    for (std::size_t t = element.first_face; t < element.first_face + element.face_count(); ++t) {
      check_cancelled_every(t, obj.stop);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t corner = element.first_corner + as_size(obj.face_corners[t][k]);
        combiner.add(t, k, has_normals ? obj.corners[corner].normal : kNoNormal);
      }
    }
  return combiner.take();
}

Vertices vertices_of(const MeshFile& file, const Surface& surface,
                     const UnwrappedSurface& unwrapped) {
  Combiner combiner({surface, unwrapped, file.normals});
  for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t) {
    check_cancelled_every(t, file.stop);
    for (std::size_t k = 0; k < 3; ++k)
      combiner.add(t, k, file.normals.empty() ? kNoNormal : surface.mesh.faces[t][k]);
  }
  return combiner.take();
}

std::string_view bytes_of(const std::vector<Float3>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Float3)};
}

Json vec3_accessor(const std::vector<Float3>& values, NewViews& views) {
  return {{"bufferView", views.add(bytes_of(values), 0, kArrayBufferTarget)},
          {"componentType", ComponentType::f32},
          {"count", values.size()},
          {"type", "VEC3"}};
}

/// Whatever bytes the name has, the document is UTF-8.
Json material(const std::string& name) {
  const std::string text = Json(name).dump(-1, ' ', false, Json::error_handler_t::replace);
  return {{"name", Json::parse(text)}};
}

/// The primitives of all parts with faces. materials: [part] their names, empty for none.
void add_primitives(const Vertices& vertices, std::span<const std::string> materials,
                    const Gltf& empty, NewViews& views, Json& json) {
  Json& accessors = json["accessors"];
  Json used = Json::array();
  Json attributes = {{"POSITION", 0}, {"TEXCOORD_0", 1}};
  if (!vertices.normals.empty()) attributes["NORMAL"] = 2;
  for (const auto& [part, corners] : vertices.corners) {
    Json primitive = {{"attributes", attributes}, {"indices", accessors.size()}};
    accessors.push_back(index_accessor(empty, std::nullopt, corners, views));
    if (as_size(part) < materials.size() && !materials[as_size(part)].empty()) {
      primitive["material"] = used.size();
      used.push_back(material(materials[as_size(part)]));
    }
    json["meshes"][0]["primitives"].push_back(std::move(primitive));
  }
  if (!used.empty()) json["materials"] = std::move(used);  // last: accessors may move in memory
}

std::string write_gltf(const Vertices& vertices, std::span<const std::string> materials,
                       const std::stop_token& stop, Format output) {
  Gltf empty;
  empty.stop = stop;
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
  if (!vertices.normals.empty()) accessors.push_back(vec3_accessor(vertices.normals, views));
  add_primitives(vertices, materials, empty, views, document.json);
  return assemble(empty, std::move(document), output);
}

}  // namespace

std::vector<Index> sources_in_gltf(const Obj& obj, const Surface& surface,
                                   const UnwrappedSurface& unwrapped) {
  return vertices_of(obj, surface, unwrapped).sources;
}

std::vector<Index> sources_in_gltf(const MeshFile& file, const Surface& surface,
                                   const UnwrappedSurface& unwrapped) {
  return vertices_of(file, surface, unwrapped).sources;
}

std::vector<Note> note_on_materials(const Obj& obj) {
  const auto count = static_cast<std::size_t>(
      std::ranges::count_if(obj.materials, [](const std::string& name) { return !name.empty(); }));
  if (count == 0 && !obj.has_material_library) return {};
  return {{NoteCode::data_dropped,
           "The result has the names of the OBJ's materials (" + std::to_string(count) +
               "), without their colours and textures: no file that mtllib names is read."}};
}

std::string obj_as_gltf(const Obj& obj, const Surface& surface, const UnwrappedSurface& unwrapped,
                        Format output) {
  return write_gltf(vertices_of(obj, surface, unwrapped), obj.materials, obj.stop, output);
}

std::string mesh_file_as_gltf(const MeshFile& file, const Surface& surface,
                              const UnwrappedSurface& unwrapped, Format output) {
  return write_gltf(vertices_of(file, surface, unwrapped), {}, file.stop, output);
}

}  // namespace unwrapd::asset
