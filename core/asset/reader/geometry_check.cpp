// Checks each triangle primitive before its geometry is decoded, and bounds the amount of geometry.
// The bounds count shared geometry once. Primitives that use the same vertex accessors form a pool,
// whose vertices are split together.
#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "core/asset/gltf/extensions.hpp"
#include "core/asset/reader/steps.hpp"

namespace unwrapd::asset::reader {
namespace {

constexpr std::size_t kMaxZeroElements = 500'000;  // that exist only as a count, not in the file
constexpr std::size_t kMaxSharing = 64;            // bytes of attributes over bytes of buffers
constexpr std::size_t kBytesPerFace = 40;          // of memory for reading
constexpr std::size_t kFreeAttributeBytes = std::size_t{16} << 20;  // that may share any bytes

void check_position(const Accessor& accessor, bool quantized, const Place& place) {
  const bool narrow = component_bytes(accessor.type) < 4;
  if (accessor.components != 3 || !(accessor.type == ComponentType::f32 || (narrow && quantized)))
    fail(ErrorCode::malformed_gltf, place,
         "POSITION must be VEC3 of float, or of small integers with KHR_mesh_quantization; "
         "export the asset again");
}

void check_indices(const Accessor& accessor, const Place& place) {
  const bool is_unsigned = accessor.type == ComponentType::u8 ||
                           accessor.type == ComponentType::u16 ||
                           accessor.type == ComponentType::u32;
  if (accessor.components != 1 || !is_unsigned || accessor.normalized)
    fail(ErrorCode::malformed_gltf, place,
         "indices must be SCALAR of unsigned whole numbers; export the asset again");
}

void check_equal_counts(const Gltf& gltf, const Primitive& primitive) {
  const std::size_t count = gltf.accessors[primitive.position].count;
  const auto is_wrong = [&](std::size_t accessor) {
    return gltf.accessors[accessor].count != count;
  };
  const bool attribute = std::any_of(primitive.attributes.begin(), primitive.attributes.end(),
                                     [&](const auto& item) { return is_wrong(item.second); });
  if (attribute || std::any_of(primitive.targets.begin(), primitive.targets.end(), is_wrong))
    fail(ErrorCode::malformed_gltf, primitive_place(primitive),
         "all attributes and morph targets of a primitive must have as many elements as POSITION; "
         "export the asset again");
}

std::size_t face_bound(const Gltf& gltf, const Primitive& primitive) {
  const std::size_t corners = gltf.accessors[primitive.indices.value_or(primitive.position)].count;
  return primitive.mode == Mode::triangles ? corners / 3
                                           : corners - std::min<std::size_t>(corners, 2);
}

/// The accessors whose elements belong to the primitive's vertices, but for the UVs we replace.
std::vector<std::size_t> vertex_accessors(const Gltf& gltf, const Primitive& primitive) {
  std::vector<std::size_t> accessors = primitive.targets;
  for (const auto& [semantic, accessor] : primitive.attributes)
    if (semantic != gltf.texcoord) accessors.push_back(accessor);
  std::sort(accessors.begin(), accessors.end());
  accessors.erase(std::unique(accessors.begin(), accessors.end()), accessors.end());
  return accessors;
}

/// Adds up the document's demands, and throws when a sum exceeds its bound.
class Account {
 public:
  Account(const Gltf& gltf, const ReadLimits& limits) : gltf_(gltf), limits_(limits) {
    for (const std::string& buffer : gltf.buffers) buffer_bytes_ += buffer.size();
  }

  void add_geometry(const Primitive& primitive) {
    if (!geometries_
             .emplace(primitive.position, primitive.indices.value_or(gltf_.accessors.size()),
                      primitive.mode)
             .second)
      return;
    add_zeros(primitive.position);
    if (primitive.indices) add_zeros(*primitive.indices);
    faces_ += face_bound(gltf_, primitive);
    if (faces_ > static_cast<std::size_t>(limits_.max_faces))
      fail(ErrorCode::too_many_faces, primitive_place(primitive),
           "the asset has more than " + std::to_string(limits_.max_faces) +
               " triangles; simplify it or split it");
    if (faces_ > limits_.max_bytes / kBytesPerFace)
      fail(
          ErrorCode::too_much_memory, primitive_place(primitive),
          "the asset's triangles would take more memory than one job may; simplify it or split it");
  }

  void add_pool(const Primitive& primitive, const std::vector<std::size_t>& accessors) {
    vertices_ += gltf_.accessors[primitive.position].count;
    if (vertices_ > static_cast<std::size_t>(std::min<std::int64_t>(
                        limits_.max_vertices, std::numeric_limits<Index>::max())))
      fail(ErrorCode::too_many_vertices, primitive_place(primitive),
           "the asset has more than " + std::to_string(limits_.max_vertices) +
               " vertices; simplify it or split it");
    for (const std::size_t accessor : accessors)
      attribute_bytes_ +=
          gltf_.accessors[accessor].view
              ? gltf_.accessors[accessor].count * gltf_.accessors[accessor].element_bytes
              : 0;
    if (attribute_bytes_ > kFreeAttributeBytes + kMaxSharing * buffer_bytes_)
      fail(ErrorCode::too_many_vertices, primitive_place(primitive),
           "too many attributes share the same bytes; export the asset again");
  }

 private:
  void add_zeros(std::size_t accessor) {
    if (gltf_.accessors[accessor].view) return;
    zeros_ += gltf_.accessors[accessor].count;
    if (zeros_ > kMaxZeroElements)
      fail(ErrorCode::too_many_vertices, accessor_place(accessor).at("count"),
           "too many elements without a buffer view; export the asset with its data");
  }

  const Gltf& gltf_;
  const ReadLimits& limits_;
  std::set<std::tuple<std::size_t, std::size_t, Mode>> geometries_;
  std::size_t buffer_bytes_ = 0;
  std::size_t attribute_bytes_ = 0;
  std::size_t vertices_ = 0;
  std::size_t faces_ = 0;
  std::size_t zeros_ = 0;
};

}  // namespace

void check_geometry(Gltf& gltf, const ReadLimits& limits) {
  const bool quantized = uses_extension(gltf.json, "KHR_mesh_quantization");
  Account account(gltf, limits);
  std::map<std::vector<std::size_t>, std::size_t> pools;
  for (Primitive& primitive : gltf.primitives) {
    if (!primitive.has_triangles) continue;
    check_position(gltf.accessors[primitive.position], quantized,
                   accessor_place(primitive.position));
    if (primitive.indices)
      check_indices(gltf.accessors[*primitive.indices], accessor_place(*primitive.indices));
    check_equal_counts(gltf, primitive);
    account.add_geometry(primitive);
    const std::vector<std::size_t> accessors = vertex_accessors(gltf, primitive);
    const auto [pool, is_new] = pools.try_emplace(accessors, pools.size());
    if (is_new) account.add_pool(primitive, accessors);
    primitive.pool = pool->second;
  }
  gltf.pool_count = pools.size();
}

}  // namespace unwrapd::asset::reader
