// A glTF vertex is a position, a UV and a normal together. The corners of an OBJ combine them
// freely, so that each combination becomes a vertex.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <unordered_map>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/bytes.hpp"
#include "core/asset/convert/convert.hpp"
#include "core/asset/convert/float_frame.hpp"
#include "core/asset/gltf/new_accessors.hpp"
#include "core/asset/obj/materials.hpp"
#include "core/asset/writer/patch.hpp"
#include "core/base/cancel.hpp"
#include "core/base/splitmix64.hpp"
#include "core/base/srgb.hpp"

namespace unwrapd::asset::convert {
namespace {

using Float3 = std::array<float, 3>;

Float3 as_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

struct Vertices {
  std::vector<Float3> normals;  ///< empty unless every corner has one
  std::vector<std::array<float, 2>> uv;
  std::vector<std::array<float, 2>> old_uv;     ///< of the input; empty unless they are kept
  std::vector<Index> sources;                   ///< in the input
  std::span<const Colour> colours = {};         ///< of the sources; empty if the input has none
  std::map<Index, std::vector<Index>> corners;  ///< [part]: three to a face
};

/// What the corners of a surface are made of, whatever format it came in.
struct Parts {
  const Surface& surface;
  const UnwrappedSurface& unwrapped;
  std::span<const Vec3> normals;         ///< empty unless every corner has one
  std::span<const Vec2> texcoords = {};  ///< of the input; empty unless they are kept
};

/// What makes a vertex, beside its surface.
struct CornerData {
  Index normal = obj::kNoNormal;      ///< in Parts::normals
  Index texcoord = obj::kNoTexcoord;  ///< in Parts::texcoords
};

class Combiner {
 public:
  explicit Combiner(const Parts& parts) : parts_(parts) {}

  /// Corner k of face t.
  void add(std::size_t t, std::size_t k, const CornerData& data) {
    vertices_.corners[parts_.surface.part[t]].push_back(
        number_of({parts_.unwrapped.faces[t][k], data.normal, data.texcoord}));
  }

  Vertices take() { return std::move(vertices_); }

 private:
  using Key = std::array<Index, 3>;  ///< vertex, normal, texture coordinates
  struct HashOfKey {
    std::size_t operator()(const Key& key) const {
      std::uint64_t hash = 0;
      for (const Index number : key) hash = splitmix64(hash ^ static_cast<std::uint32_t>(number));
      return hash;
    }
  };

  Index number_of(const Key& key) {
    const auto [vertex, normal, texcoord] = key;
    const auto [found, is_new] =
        numbers_.try_emplace(key, static_cast<Index>(vertices_.sources.size()));
    if (!is_new) return found->second;
    vertices_.sources.push_back(parts_.unwrapped.source[as_size(vertex)]);
    const Vec2& uv = parts_.unwrapped.uv[as_size(vertex)];
    vertices_.uv.push_back({static_cast<float>(uv.x()), static_cast<float>(1 - uv.y())});
    if (normal != obj::kNoNormal) {
      const Vec3 unit = parts_.normals[as_size(normal)].stableNormalized();
      vertices_.normals.push_back(as_floats(unit.squaredNorm() > 0 ? unit : Vec3(0, 0, 1)));
    }
    if (!parts_.texcoords.empty()) vertices_.old_uv.push_back(old_uv(texcoord));
    return found->second;
  }

  /// 0 where the corner has none, or none that can be read.
  [[nodiscard]] std::array<float, 2> old_uv(Index texcoord) const {
    if (texcoord < 0 || as_size(texcoord) >= parts_.texcoords.size()) return {};
    const Vec2& uv = parts_.texcoords[as_size(texcoord)];
    const Eigen::Vector2f written(static_cast<float>(uv.x()), static_cast<float>(1 - uv.y()));
    if (!written.allFinite()) return {};
    return {written.x(), written.y()};
  }

  Parts parts_;
  Vertices vertices_;
  std::unordered_map<Key, Index, HashOfKey> numbers_;
};

bool has_all_normals(const obj::Obj& obj) {
  return !obj.normals.empty() &&
         std::ranges::all_of(obj.elements, [&](const obj::Element& element) {
           const auto corners =
               std::span(obj.corners).subspan(element.first_corner, element.corner_count);
           return element.face_count() == 0 ||
                  std::ranges::all_of(
                      corners, [](const obj::Corner& c) { return c.normal != obj::kNoNormal; });
         });
}

Vertices vertices_of(const obj::Obj& obj, const Surface& surface, const UnwrappedSurface& unwrapped,
                     bool keeps_texcoords) {
  const bool has_normals = has_all_normals(obj);
  const std::vector<Vec2> texcoords =
      keeps_texcoords ? obj::texcoords_of(obj) : std::vector<Vec2>();
  Combiner combiner({surface, unwrapped, obj.normals, texcoords});
  for (const obj::Element& element : obj.elements)
    for (std::size_t t = element.first_face; t < element.first_face + element.face_count(); ++t) {
      check_cancelled_every(t, obj.stop);
      for (std::size_t k = 0; k < 3; ++k) {
        const obj::Corner& corner =
            obj.corners[element.first_corner + as_size(obj.face_corners[t][k])];
        combiner.add(t, k,
                     {has_normals ? corner.normal : obj::kNoNormal,
                      keeps_texcoords ? corner.texcoord : obj::kNoTexcoord});
      }
    }
  Vertices vertices = combiner.take();
  vertices.colours = obj.colours;
  return vertices;
}

Vertices vertices_of(const mesh_files::MeshFile& file, const Surface& surface,
                     const UnwrappedSurface& unwrapped) {
  Combiner combiner({surface, unwrapped, file.normals});
  for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t) {
    check_cancelled_every(t, file.stop);
    for (std::size_t k = 0; k < 3; ++k)
      combiner.add(t, k, {file.normals.empty() ? obj::kNoNormal : surface.mesh.faces[t][k]});
  }
  Vertices vertices = combiner.take();
  vertices.colours = file.colours;
  return vertices;
}

/// The positions of the vertices relative to an origin.
std::vector<Float3> positions_from(const Vec3& origin, const TriMesh& mesh,
                                   const std::vector<Index>& sources) {
  std::vector<Float3> positions;
  positions.reserve(sources.size());
  for (const Index source : sources)
    positions.push_back(as_floats(mesh.positions[as_size(source)] - origin));
  return positions;
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

/// Linear in light, as glTF wants colours; 16 bits keep the 8 bits of sRGB.
Json colour_accessor(const Vertices& vertices, const std::stop_token& stop, NewViews& views) {
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  std::vector<std::array<std::uint16_t, 4>> values;
  values.reserve(vertices.sources.size());
  Pace pace(stop);
  for (const Index source : vertices.sources) {
    pace.add(8);
    const Colour colour = as_shown(vertices.colours[as_size(source)]);
    auto& value = values.emplace_back();
    for (std::size_t k = 0; k < value.size(); ++k)
      value[k] = static_cast<std::uint16_t>(
          std::lround(kMost * (k < 3 ? from_srgb(colour[k]) : colour[k])));
  }
  const std::string_view bytes(reinterpret_cast<const char*>(values.data()),
                               values.size() * sizeof(values.front()));
  return {{"bufferView", views.add(bytes, 0, kArrayBufferTarget)},
          {"componentType", ComponentType::u16},
          {"normalized", true},
          {"count", values.size()},
          {"type", "VEC4"}};
}

/// The primitives of all parts with faces. Those whose material has an image go without colours: a
/// glTF multiplies the two, while programs that read an OBJ show one of them.
void add_primitives(const Vertices& vertices, const obj::Obj* obj, const Json& attributes,
                    const Gltf& empty, NewViews& views, Json& json) {
  Json& accessors = json["accessors"];
  for (const auto& [part, corners] : vertices.corners) {
    Json primitive = {{"attributes", attributes}, {"indices", accessors.size()}};
    if (obj != nullptr && obj::has_image(*obj, part)) primitive["attributes"].erase("COLOR_0");
    accessors.push_back(index_accessor(empty, std::nullopt, corners, views));
    json["meshes"][0]["primitives"].push_back(std::move(primitive));
  }
}

/// Adds the accessors of all vertices. Returns the attributes of primitives.
Json add_vertices(const std::vector<Float3>& positions, const Vertices& vertices, const Gltf& empty,
                  NewViews& views, Json& accessors) {
  accessors.push_back(vec3_accessor(positions, views));
  set_bounds(accessors.back(), bytes_of(positions), sizeof(Float3), 3);
  accessors.push_back(texcoord_accessor(empty, std::nullopt, vertices.uv, views));
  Json attributes = {{"POSITION", 0}, {"TEXCOORD_0", 1}};
  if (!vertices.normals.empty()) {
    attributes["NORMAL"] = accessors.size();
    accessors.push_back(vec3_accessor(vertices.normals, views));
  }
  if (!vertices.colours.empty()) {
    attributes["COLOR_0"] = accessors.size();
    accessors.push_back(colour_accessor(vertices, empty.stop, views));
  }
  if (!vertices.old_uv.empty()) {
    attributes["TEXCOORD_1"] = 1;
    attributes["TEXCOORD_0"] = accessors.size();
    accessors.push_back(texcoord_accessor(empty, std::nullopt, vertices.old_uv, views));
  }
  return attributes;
}

/// obj: null for a format without materials.
std::string write_gltf(const TriMesh& mesh, Vertices vertices, const obj::Obj* obj,
                       const std::stop_token& stop, Format output) {
  const auto has_image = [&](const auto& own) { return obj::has_image(*obj, own.first); };
  if (obj != nullptr && std::ranges::all_of(vertices.corners, has_image)) vertices.colours = {};
  const Vec3 origin = float_frame(mesh, stop).origin;
  const std::vector<Float3> positions = positions_from(origin, mesh, vertices.sources);
  Gltf empty;
  empty.stop = stop;
  PatchedDocument document{Json::parse(R"({
    "asset": {"version": "2.0", "generator": "unwrapd"},
    "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": []}], "accessors": [], "bufferViews": [], "buffers": []})"),
                           {}};
  if (origin != Vec3::Zero())
    document.json["nodes"][0]["translation"] = {origin.x(), origin.y(), origin.z()};
  NewViews views(document, 0);
  const Json attributes =
      add_vertices(positions, vertices, empty, views, document.json["accessors"]);
  add_primitives(vertices, obj, attributes, empty, views, document.json);
  std::vector<Index> parts;
  for (const auto& [part, corners] : vertices.corners) parts.push_back(part);
  if (obj != nullptr) obj::add_materials(*obj, parts, views, document.json);
  return writer::assemble(empty, std::move(document), output);
}

}  // namespace

std::vector<Index> sources_in_gltf(const obj::Obj& obj, const Surface& surface,
                                   const UnwrappedSurface& unwrapped, bool keeps_texcoords) {
  return vertices_of(obj, surface, unwrapped, keeps_texcoords).sources;
}

std::vector<Index> sources_in_gltf(const mesh_files::MeshFile& file, const Surface& surface,
                                   const UnwrappedSurface& unwrapped) {
  return vertices_of(file, surface, unwrapped).sources;
}

std::string obj_as_gltf(const obj::Obj& obj, const Surface& surface,
                        const UnwrappedSurface& unwrapped, bool keeps_texcoords, Format output) {
  return write_gltf(surface.mesh, vertices_of(obj, surface, unwrapped, keeps_texcoords), &obj,
                    obj.stop, output);
}

std::string mesh_file_as_gltf(const mesh_files::MeshFile& file, const Surface& surface,
                              const UnwrappedSurface& unwrapped, Format output) {
  return write_gltf(surface.mesh, vertices_of(file, surface, unwrapped), nullptr, file.stop,
                    output);
}

}  // namespace unwrapd::asset::convert
