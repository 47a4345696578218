// KHR_draco_mesh_compression. The decoder is Draco's own with two checks in it: sizes are read
// ahead and judged before Draco allocates memory for them. A face takes at least a fraction of a
// byte of the bitstream, a point belongs to some face, and an attribute has few components. A
// bitstream that claims more is an attack on memory.
#include "core/asset/codec/draco.hpp"

#include <draco/attributes/point_attribute.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include <array>
#include <cstring>
#include <limits>

namespace unwrapd::asset::codec {
namespace {

constexpr std::uint64_t kFacesPerByte = 8;    // good encodings reach 2
constexpr std::uint64_t kFreeFaces = 20'000;  // allowed in any bitstream
constexpr std::uint64_t kFreePoints = 1'000;  // beyond three points a face
constexpr int kMaxAttributeData = 32;         // seams of their own
constexpr int kMaxComponents = 64;            // of all attributes together
constexpr std::uint16_t kVarintCounts = DRACO_BITSTREAM_VERSION(2, 2);
constexpr std::uint16_t kVarintEdgebreaker = DRACO_BITSTREAM_VERSION(2, 0);

bool read_count(draco::DecoderBuffer& buffer, bool varint, std::uint64_t& count) {
  std::uint32_t value = 0;
  const bool good = varint ? draco::DecodeVarint(&value, &buffer) : buffer.Decode(&value);
  count = value;
  return good;
}

/// The sizes that the first bytes of the connectivity claim.
struct Claim {
  std::uint64_t faces = 0;
  std::uint64_t points = 0;
};

bool read_claim(draco::DecoderBuffer buffer, std::uint16_t version, draco::MeshSequentialDecoder*,
                Claim& claim) {
  const bool varint = version >= kVarintCounts;
  return read_count(buffer, varint, claim.faces) && read_count(buffer, varint, claim.points);
}

bool read_claim(draco::DecoderBuffer buffer, std::uint16_t version, draco::MeshEdgebreakerDecoder*,
                Claim& claim) {
  const bool varint = version >= kVarintEdgebreaker;
  std::uint64_t new_vertices = 0;
  std::uint8_t attribute_data = 0;
  return (version >= kVarintCounts || read_count(buffer, varint, new_vertices)) &&
         read_count(buffer, varint, claim.points) && read_count(buffer, varint, claim.faces) &&
         new_vertices <= claim.points && buffer.Decode(&attribute_data) &&
         attribute_data <= kMaxAttributeData;
}

bool is_plausible(const Claim& claim, std::uint64_t bytes, const ReadLimits& limits) {
  return claim.faces <= kFreeFaces + kFacesPerByte * bytes &&
         claim.points <= 3 * claim.faces + kFreePoints &&
         claim.faces <= static_cast<std::uint64_t>(limits.max_faces) &&
         claim.points <= static_cast<std::uint64_t>(limits.max_vertices);
}

/// Draco's decoder of one method, with the two checks.
template <class Base>
class GuardedDecoder : public Base {
 public:
  explicit GuardedDecoder(const ReadLimits& limits) : limits_(limits) {}

 protected:
  bool DecodeConnectivity() override {
    Claim claim;
    return read_claim(*this->buffer(), this->bitstream_version(), static_cast<Base*>(nullptr),
                      claim) &&
           is_plausible(claim, static_cast<std::uint64_t>(this->buffer()->remaining_size()),
                        limits_) &&
           Base::DecodeConnectivity();
  }

  bool DecodeAllAttributes() override {
    int components = 0;
    for (int i = 0; i < this->point_cloud()->num_attributes(); ++i)
      components += this->point_cloud()->attribute(i)->num_components();
    return components <= kMaxComponents && Base::DecodeAllAttributes();
  }

 private:
  const ReadLimits& limits_;
};

template <class Base>
bool decode_with(std::string_view bytes, const ReadLimits& limits, draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const draco::DecoderOptions options;
  GuardedDecoder<Base> decoder(limits);
  return decoder.Decode(options, &buffer, &mesh).ok();
}

bool decode(std::string_view bytes, const ReadLimits& limits, draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return false;
  if (header.encoder_type != draco::TRIANGULAR_MESH) return false;
  return header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING
             ? decode_with<draco::MeshSequentialDecoder>(bytes, limits, mesh)
         : header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING
             ? decode_with<draco::MeshEdgebreakerDecoder>(bytes, limits, mesh)
             : false;
}

/// Whether every point has a value, and the values lie in the attribute's memory. glTF has no
/// booleans, which Draco copies from the file unchecked.
bool is_sound(const draco::PointAttribute& attribute, std::uint32_t points) {
  if (attribute.data_type() == draco::DT_BOOL) return false;
  const auto bytes = static_cast<std::uint64_t>(attribute.byte_stride()) * attribute.size();
  if (attribute.buffer() == nullptr || bytes > attribute.buffer()->data_size()) return false;
  if (attribute.is_mapping_identity()) return points <= attribute.size();
  if (attribute.indices_map_size() < points) return false;
  for (draco::PointIndex i(0); i < points; ++i)
    if (attribute.mapped_index(i).value() >= attribute.size()) return false;
  return true;
}

template <class Component>
bool convert(const draco::PointAttribute& attribute, std::uint32_t points, const Accessor& accessor,
             std::size_t stride, std::string& bytes) {
  for (draco::PointIndex i(0); i < points; ++i) {
    std::array<Component, 16> element{};
    if (!attribute.ConvertValue(attribute.mapped_index(i),
                                static_cast<std::int8_t>(accessor.components), element.data()))
      return false;
    std::memcpy(bytes.data() + i.value() * stride, element.data(),
                accessor.components * sizeof(Component));
  }
  return true;
}

bool convert_all(const draco::PointAttribute& attribute, std::uint32_t points,
                 const Accessor& accessor, std::size_t stride, std::string& bytes) {
  switch (accessor.type) {
    case ComponentType::i8:
      return convert<std::int8_t>(attribute, points, accessor, stride, bytes);
    case ComponentType::u8:
      return convert<std::uint8_t>(attribute, points, accessor, stride, bytes);
    case ComponentType::i16:
      return convert<std::int16_t>(attribute, points, accessor, stride, bytes);
    case ComponentType::u16:
      return convert<std::uint16_t>(attribute, points, accessor, stride, bytes);
    case ComponentType::u32:
      return convert<std::uint32_t>(attribute, points, accessor, stride, bytes);
    case ComponentType::f32:
      return convert<float>(attribute, points, accessor, stride, bytes);
  }
  return false;
}

[[noreturn]] void refuse(const Place& place, const std::string& message) {
  fail(ErrorCode::malformed_draco, place, message + "; compress the asset again");
}

void check_faces(const draco::Mesh& mesh, const Place& place) {
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& point : mesh.face(f))
      if (point.value() >= mesh.num_points())
        refuse(place, "a face of the Draco data has a vertex that does not exist");
}

}  // namespace

DracoMesh::DracoMesh(std::string_view bytes, const ReadLimits& limits, const Place& place)
    : mesh_(std::make_unique<draco::Mesh>()), place_(place) {
  if (!decode(bytes, limits, *mesh_))
    refuse(place, "the Draco data is damaged, is no mesh, or claims more than is allowed");
  check_faces(*mesh_, place);
}

DracoMesh::~DracoMesh() = default;

std::size_t DracoMesh::point_count() const { return mesh_->num_points(); }

std::vector<Index> DracoMesh::corners() const {
  std::vector<Index> corners;
  corners.reserve(std::size_t{3} * mesh_->num_faces());
  for (draco::FaceIndex f(0); f < mesh_->num_faces(); ++f)
    for (const draco::PointIndex& point : mesh_->face(f))
      corners.push_back(static_cast<Index>(point.value()));
  return corners;
}

std::string DracoMesh::elements(std::size_t id, const Accessor& accessor) const {
  const bool is_id = id <= std::numeric_limits<std::uint32_t>::max();
  const draco::PointAttribute* attribute =
      is_id ? mesh_->GetAttributeByUniqueId(static_cast<std::uint32_t>(id)) : nullptr;
  const std::size_t stride = (accessor.element_bytes + 3) / 4 * 4;
  std::string bytes(mesh_->num_points() * stride, '\0');
  const bool is_plain =
      accessor.element_bytes == accessor.components * component_bytes(accessor.type);
  if (attribute == nullptr || !is_plain || !is_sound(*attribute, mesh_->num_points()) ||
      !convert_all(*attribute, mesh_->num_points(), accessor, stride, bytes))
    refuse(place_, "the Draco data has no usable attribute " + std::to_string(id));
  return bytes;
}

}  // namespace unwrapd::asset::codec
