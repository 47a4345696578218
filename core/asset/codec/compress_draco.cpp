// A bitstream for each geometry: Draco's sequential method keeps the order of vertices and faces,
// and without quantisation their values. Edgebreaker would be smaller but renumbers both. Accessors
// that something else needs as well keep their bytes beside it. Values are rounded to grids that
// we choose, as Draco's own are of one primitive and would open cracks between two.
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <tuple>

#include "core/asset/base/as_size.hpp"
#include "core/asset/codec/compress.hpp"
#include "core/asset/codec/draco_grid.hpp"
#include "core/asset/gltf/elements.hpp"
#include "core/asset/gltf/new_accessors.hpp"
#include "core/asset/gltf/references.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::codec {
namespace {

constexpr const char* kExtension = "KHR_draco_mesh_compression";
constexpr int kCompressionLevel = 7;  // of 10; what Draco's own tools take

draco::DataType data_type(ComponentType type) {
  switch (type) {
    case ComponentType::i8:
      return draco::DT_INT8;
    case ComponentType::u8:
      return draco::DT_UINT8;
    case ComponentType::i16:
      return draco::DT_INT16;
    case ComponentType::u16:
      return draco::DT_UINT16;
    case ComponentType::u32:
      return draco::DT_UINT32;
    case ComponentType::f32:
      break;
  }
  return draco::DT_FLOAT32;
}

draco::GeometryAttribute::Type kind_of(const std::string& semantic) {
  if (semantic == "POSITION") return draco::GeometryAttribute::POSITION;
  if (semantic == "NORMAL") return draco::GeometryAttribute::NORMAL;
  if (semantic.starts_with("TEXCOORD_")) return draco::GeometryAttribute::TEX_COORD;
  if (semantic.starts_with("COLOR_")) return draco::GeometryAttribute::COLOR;
  return draco::GeometryAttribute::GENERIC;
}

bool is_plain(const Accessor& accessor) {
  return accessor.element_bytes == accessor.components * component_bytes(accessor.type);
}

/// Adds the accessor's elements, a value for each point.
void add_attribute(const Gltf& gltf, const std::string& semantic, std::size_t number,
                   draco::Mesh& mesh) {
  const Accessor& accessor = gltf.accessors[number];
  draco::GeometryAttribute header;
  header.Init(kind_of(semantic), nullptr, static_cast<std::int8_t>(accessor.components),
              data_type(accessor.type), accessor.normalized,
              static_cast<std::int64_t>(accessor.element_bytes), 0);
  const int id = mesh.AddAttribute(header, true, static_cast<std::uint32_t>(accessor.count));
  throw_if_cancelled(gltf.stop);
  const Elements elements(gltf, number);
  const std::string zeros(accessor.element_bytes, '\0');
  for (std::size_t i = 0; i < accessor.count; ++i) {
    check_cancelled_every(i, gltf.stop);
    const char* bytes = elements.at(i);
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(static_cast<std::uint32_t>(i)),
                                          bytes == nullptr ? zeros.data() : bytes);
  }
}

std::vector<Index> corners_of(const Gltf& gltf, const Primitive& primitive) {
  const std::size_t count = gltf.accessors[primitive.indices.value_or(primitive.position)].count;
  std::vector<Index> corners(count);
  if (!primitive.indices) {
    for (std::size_t i = 0; i < count; ++i) corners[i] = static_cast<Index>(i);
    return corners;
  }
  const Elements indices(gltf, *primitive.indices);
  for (std::size_t i = 0; i < count; ++i) {
    check_cancelled_every(i, gltf.stop);
    corners[i] = static_cast<Index>(indices.unsigned_at(i));
  }
  return corners;
}

std::string exact_text(float value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// Draco's own setter of a grid writes its numbers with six decimals.
void set_grid(draco::ExpertEncoder& encoder, int attribute, const DracoGrid& grid,
              std::size_t components) {
  draco::Options options;
  std::string origin;
  for (std::size_t k = 0; k < components; ++k) origin += exact_text(grid.origin[k]) + " ";
  options.SetInt("quantization_bits", grid.bits);
  options.SetString("quantization_origin", origin);
  options.SetString("quantization_range", exact_text(grid.range));
  encoder.options().SetAttributeOptions(attribute, options);
}

/// positions: of the primitive's mesh; null: nothing is rounded.
void set_grids(const Gltf& gltf, const Primitive& primitive, const DracoGrid* positions,
               draco::ExpertEncoder& encoder) {
  if (positions == nullptr) return;
  encoder.options().SetGlobalBool("compress_connectivity", true);
  int attribute = 0;
  for (const auto& [semantic, number] : primitive.attributes) {
    const bool is_float = gltf.accessors[number].type == ComponentType::f32;
    if (semantic == "POSITION") set_grid(encoder, attribute, *positions, 3);
    if (semantic == "NORMAL" && is_float)
      encoder.SetAttributeQuantization(attribute, kDracoNormalBits);
    if (semantic.starts_with("TEXCOORD_") && is_float)
      if (const auto grid = exact_grid(gltf, number)) set_grid(encoder, attribute, *grid, 2);
    ++attribute;
  }
}

/// A bitstream, or nothing if Draco cannot express the primitive.
std::string bitstream_of(const Gltf& gltf, const Primitive& primitive, const DracoGrid* positions) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(gltf.accessors[primitive.position].count));
  for (const auto& [semantic, accessor] : primitive.attributes)
    add_attribute(gltf, semantic, accessor, mesh);
  const std::vector<Index> corners = corners_of(gltf, primitive);
  for (std::size_t c = 0; c + 2 < corners.size(); c += 3)
    mesh.AddFace({draco::PointIndex(static_cast<std::uint32_t>(corners[c])),
                  draco::PointIndex(static_cast<std::uint32_t>(corners[c + 1])),
                  draco::PointIndex(static_cast<std::uint32_t>(corners[c + 2]))});
  throw_if_cancelled(gltf.stop);
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetSpeedOptions(10 - kCompressionLevel, 10 - kCompressionLevel);
  set_grids(gltf, primitive, positions, encoder);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeToBuffer(&buffer).ok()) return {};
  return {buffer.data(), buffer.size()};
}

class DracoPacker {
 public:
  DracoPacker(const Gltf& gltf, bool with_fallback, std::optional<int> position_bits)
      : gltf_(gltf),
        with_fallback_(with_fallback),
        grids_(position_bits ? position_grids(gltf, *position_bits) : Grids()),
        patched_{gltf.json, {}},
        views_(patched_, gltf.buffers.size()),
        left_(count_accessor_references(gltf.json, gltf.accessors.size())) {}

  void pack(const Primitive& primitive) {
    if (!can_be_packed(primitive)) return;
    const auto grid = grids_.find(primitive.mesh);
    const DracoGrid* const positions = grid == grids_.end() ? nullptr : &grid->second;
    const Key key{primitive.attributes, primitive.indices, positions};
    auto found = done_.find(key);
    if (found == done_.end()) {
      const std::string bytes = bitstream_of(gltf_, primitive, positions);
      if (bytes.empty()) return;
      found = done_.emplace(key, Done{views_.add(bytes, 0, 0), indices_of(primitive)}).first;
    }
    Json& json = patched_.json["meshes"][primitive.mesh]["primitives"][primitive.number];
    Json ids = Json::object();
    for (const auto& [semantic, accessor] : primitive.attributes) {
      ids[semantic] = ids.size();
      --left_[accessor];
    }
    if (primitive.indices) --left_[*primitive.indices];
    json["indices"] = found->second.indices;
    json["extensions"][kExtension] = {{"bufferView", found->second.view}, {"attributes", ids}};
  }

  PatchedDocument finish() {
    if (done_.empty()) return std::move(patched_);
    patched_.json["extensionsUsed"].push_back(kExtension);
    if (with_fallback_) return std::move(patched_);
    patched_.json["extensionsRequired"].push_back(kExtension);
    for (const auto& [key, done] : done_) {
      for (const auto& [semantic, accessor] : std::get<0>(key)) {
        if (semantic == "POSITION" && std::get<2>(key) != nullptr)
          round_bounds(accessor, *std::get<2>(key));
        forget_bytes(accessor);
      }
      if (const auto& indices = std::get<1>(key)) forget_bytes(*indices);
    }
    return std::move(patched_);
  }

 private:
  using Grids = std::map<std::size_t, DracoGrid>;  // [mesh]
  using Key = std::tuple<std::vector<std::pair<std::string, std::size_t>>,
                         std::optional<std::size_t>, const DracoGrid*>;
  struct Done {
    std::size_t view = 0;
    std::size_t indices = 0;
  };

  bool can_be_packed(const Primitive& primitive) const {
    if (primitive.mode != Mode::triangles || !primitive.has_triangles) return false;
    const std::size_t corners =
        gltf_.accessors[primitive.indices.value_or(primitive.position)].count;
    for (const auto& [semantic, accessor] : primitive.attributes)
      if (!is_plain(gltf_.accessors[accessor])) return false;
    const std::size_t vertices = gltf_.accessors[primitive.position].count;
    return corners % 3 == 0 && vertices > 0 && vertices <= corners;  // readers refuse more
  }

  /// The accessor of the indices; Draco always needs one.
  std::size_t indices_of(const Primitive& primitive) {
    if (primitive.indices) return *primitive.indices;
    Json accessor = {{"componentType", ComponentType::u32},
                     {"count", gltf_.accessors[primitive.position].count},
                     {"type", "SCALAR"}};
    if (with_fallback_)
      accessor = index_accessor(gltf_, std::nullopt, corners_of(gltf_, primitive), views_);
    Json& accessors = patched_.json["accessors"];
    accessors.push_back(std::move(accessor));
    return accessors.size() - 1;
  }

  /// The bounds of what readers decode, if all readers of the accessor do.
  void round_bounds(std::size_t accessor, const DracoGrid& grid) {
    if (left_[accessor] > 0) return;
    for (const char* bound : {"min", "max"}) {
      Json& json = patched_.json["accessors"][accessor];
      if (!json.contains(bound)) continue;
      for (std::size_t k = 0; k < 3; ++k)
        json[bound][k] = grid.rounded(json[bound][k].get<float>(), k);
    }
  }

  void forget_bytes(std::size_t accessor) {
    if (left_[accessor] > 0) return;
    for (const char* part : {"bufferView", "byteOffset", "sparse"})
      patched_.json["accessors"][accessor].erase(part);
  }

  const Gltf& gltf_;
  bool with_fallback_;
  const Grids grids_;
  PatchedDocument patched_;
  NewViews views_;
  std::vector<std::size_t> left_;  ///< references by accessors that are not compressed
  std::map<Key, Done> done_;
};

}  // namespace

double draco_position_error(const Vec3& low, const Vec3& high, int position_bits) {
  const double side = (high - low).maxCoeff();
  const double half_step = side / (std::ldexp(1.0, position_bits) - 1) / 2;
  const double farthest = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  const double last_digit = farthest > 0 ? std::ldexp(1.0, std::ilogb(farthest) - 23) : 0;
  return half_step + std::ldexp(3 * side, -23) + last_digit;
}

PatchedDocument draco_compressed(const Gltf& gltf, bool with_fallback,
                                 std::optional<int> position_bits) {
  DracoPacker packer(gltf, with_fallback, position_bits);
  for (const Primitive& primitive : gltf.primitives) packer.pack(primitive);
  return packer.finish();
}

Note note_on_rounding(std::span<const Surface> surfaces, const Vec3& origin, int bits) {
  constexpr double kRoundUp = 1.005;  // so that three digits are no less
  double bound = 0;
  for (const Surface& surface : surfaces) {
    if (surface.mesh.positions.empty()) continue;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Vec3& point : surface.mesh.positions) {
      low = low.cwiseMin(point - origin);
      high = high.cwiseMax(point - origin);
    }
    bound = std::max(bound, draco_position_error(low, high, bits));
  }
  std::array<char, 32> error{};
  std::snprintf(error.data(), error.size(), "%.3g", kRoundUp * bound);
  return {NoteCode::positions_rounded,
          "Draco rounds positions to " + std::to_string(bits) + " bits, by at most " +
              error.data() + " in the units of the mesh, and normals to " +
              std::to_string(kDracoNormalBits) +
              " bits. Texture coordinates stay exact. draco_bits=none keeps all values."};
}

}  // namespace unwrapd::asset::codec
