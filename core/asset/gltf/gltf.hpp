#pragma once
// A glTF document in the form that the rest of asset uses: the author's JSON and a checked model of
// its contents. A Gltf can be indexed without checks: views lie within their buffers, accessors
// within their views, and every reference is valid.

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/asset/base/input.hpp"
#include "core/asset/gltf/json.hpp"
#include "core/asset/gltf/root.hpp"
#include "core/mesh/placement.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/asset_options.hpp"
#include "core/types/file_repair.hpp"
#include "core/types/options.hpp"

namespace unwrapd::asset {

enum class ComponentType { i8 = 5120, u8 = 5121, i16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126 };

inline constexpr int kArrayBufferTarget = 34962;
inline constexpr int kElementArrayBufferTarget = 34963;

struct View {
  std::size_t buffer = 0;
  std::size_t offset = 0;  ///< bytes
  std::size_t length = 0;  ///< bytes
  std::size_t stride = 0;  ///< bytes, 0: elements are tight
};

/// A few elements that replace those of the dense part. Indices ascend and are in range.
struct Sparse {
  std::size_t count = 0;
  std::size_t index_view = 0;
  std::size_t index_offset = 0;
  ComponentType index_type = ComponentType::u32;
  std::size_t value_view = 0;
  std::size_t value_offset = 0;
};

struct Accessor {
  std::optional<std::size_t> view;  ///< without one all elements are zero
  std::size_t offset = 0;           ///< bytes into the view
  std::size_t count = 0;            ///< elements
  std::size_t components = 1;       ///< of an element
  std::size_t element_bytes = 4;    ///< with the padding between a matrix's columns
  ComponentType type = ComponentType::f32;
  bool normalized = false;
  std::optional<Sparse> sparse;
};

enum class Mode { points, lines, line_loop, line_strip, triangles, triangle_strip, triangle_fan };

struct Primitive {
  std::size_t mesh = 0;
  std::size_t number = 0;                                       ///< in its mesh
  std::vector<std::pair<std::string, std::size_t>> attributes;  ///< semantic, accessor
  std::vector<std::size_t> targets;                             ///< accessors of all morph targets
  std::optional<std::size_t> indices;
  std::size_t position = 0;  ///< accessor of POSITION, when has_triangles
  Mode mode = Mode::triangles;
  bool has_triangles = false;  ///< a selected primitive with a triangle mode and POSITION
  std::optional<std::size_t> material;
  std::size_t piece = 0;  ///< if has_triangles: the piece of its faces
  std::size_t pool = 0;   ///< if has_triangles: the vertices that it shares with others
};

/// The faces of one or more primitives of the same geometry: a run of one surface's faces.
struct Piece {
  std::size_t surface = 0;
  std::size_t first_face = 0;
  std::size_t face_count = 0;
};

/// A node that shows a mesh.
struct MeshNode {
  std::size_t mesh = 0;
  Placement placement;
};

/// How textures are transferred.
struct Transfer {
  PageSize page;                         ///< the least size of a new texture
  std::size_t max_bytes = kNoByteLimit;  ///< of memory for the job
};

// NOLINTNEXTLINE(bugprone-exception-escape): moving a JSON value moves a pointer, and cannot throw
struct Gltf {
  Json json;                            ///< after reading: the part that writing may change
  Aside aside;                          ///< the other members of the root
  std::string texcoord = "TEXCOORD_0";  ///< the attribute that is replaced
  std::string uvs_from = "TEXCOORD_0";  ///< the attribute that existing UVs are read from
  bool is_texcoord_chosen = false;      ///< by choose_texcoord(), not by the caller
  bool has_no_free_texcoord = false;    ///< so that the chosen set replaces one that was there
  Compression came_as = Compression::none;
  bool came_with_fallback =
      false;  ///< uncompressed data was in the input too, for readers without came_as
  std::string meshopt_name = "EXT_meshopt_compression";  ///< or KHR_, as it came in
  std::vector<std::string> buffers;  ///< one for each of the document's, cut to its byteLength
  bool came_as_text = false;         ///< a .gltf, whose images may be in files beside it
  std::map<std::size_t, std::string> sent_images;  ///< [image]: its bytes, if it was sent
  std::string other_chunks;                        ///< of a GLB, as they came, after JSON and BIN
  std::vector<View> views;
  std::vector<Accessor> accessors;
  std::vector<Primitive> primitives;  ///< of all meshes, in order
  std::vector<MeshNode> mesh_nodes;   ///< of the scene, in order
  std::vector<Piece> pieces;
  std::vector<std::vector<Index>> vertices;  ///< [surface][vertex]: its number in the accessor
  std::size_t pool_count = 0;
  std::vector<std::size_t> spent_views;  ///< views of compressed data that has been decoded
  bool has_dead_bytes = false;           ///< buffers have bytes that no view refers to
  bool has_foreign_references = false;   ///< an extension may refer to views or accessors
  std::optional<Transfer> transfer;      ///< set where textures are transferred
  std::vector<FileRepair> repairs;
  std::stop_token stop;  ///< of the job, for reading and writing
};

std::size_t component_bytes(ComponentType type);
Place accessor_place(std::size_t accessor);
Place primitive_place(const Primitive& primitive);

/// A primitive of the document `json`, which is Json or const Json.
template <class Value>
Value& json_of(Value& json, const Primitive& primitive) {
  return json.at("meshes").at(primitive.mesh).at("primitives").at(primitive.number);
}

/// The bytes of an element of the dense part; requires accessor.view and element < count.
const char* dense_element(const Gltf& gltf, const Accessor& accessor, std::size_t element);

/// Entry k of a sparse accessor: the element that it replaces, and the new bytes.
std::size_t sparse_index(const Gltf& gltf, const Sparse& sparse, std::size_t k);
const char* sparse_value(const Gltf& gltf, const Accessor& accessor, std::size_t k);

/// Appends a buffer, in the model and in the document.
void add_buffer(Gltf& gltf, std::string bytes);

}  // namespace unwrapd::asset
