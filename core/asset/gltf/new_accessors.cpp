// Bytes of new accessors: grown attributes, smaller or larger indices, texture coordinates.
#include "core/asset/gltf/new_accessors.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <unordered_map>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/bytes.hpp"
#include "core/asset/base/pace.hpp"
#include "core/asset/gltf/elements.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset {
namespace {

/// Elements of vertex attributes begin at multiples of 4 bytes.
std::string dense_bytes(const Gltf& gltf, const Accessor& accessor,
                        const std::vector<Index>& copies, std::size_t stride) {
  std::string bytes((accessor.count + copies.size()) * stride, '\0');
  char* to = bytes.data();
  Pace pace(gltf.stop);
  const auto copy = [&](std::size_t element) {
    pace.add(1);
    std::memcpy(to, dense_element(gltf, accessor, element), accessor.element_bytes);
    to += stride;
  };
  for (std::size_t i = 0; i < accessor.count; ++i) copy(i);
  for (const Index source : copies) copy(as_size(source));
  return bytes;
}

/// A copy of a replaced element is replaced likewise. Copies have rising numbers, so that the
/// indices still ascend.
Json grown_sparse(const Gltf& gltf, const Accessor& accessor, Json sparse,
                  const std::vector<Index>& copies, NewViews& views) {
  std::unordered_map<std::size_t, std::size_t> entry_of;
  std::string indices;
  std::string values;
  Pace pace(gltf.stop);
  const auto add = [&](std::size_t element, std::size_t entry) {
    pace.add(4);
    append(indices, static_cast<std::uint32_t>(element));
    values.append(sparse_value(gltf, accessor, entry), accessor.element_bytes);
  };
  for (std::size_t k = 0; k < accessor.sparse->count; ++k) {
    const std::size_t element = sparse_index(gltf, *accessor.sparse, k);
    entry_of.emplace(element, k);
    add(element, k);
  }
  for (std::size_t k = 0; k < copies.size(); ++k)
    if (const auto found = entry_of.find(as_size(copies[k])); found != entry_of.end())
      add(accessor.count + k, found->second);
  sparse["count"] = indices.size() / sizeof(std::uint32_t);
  sparse["indices"]["bufferView"] = views.add(indices, 0, 0);
  sparse["indices"]["componentType"] = ComponentType::u32;
  sparse["values"]["bufferView"] = views.add(values, 0, 0);
  for (const char* part : {"indices", "values"}) sparse[part].erase("byteOffset");
  return sparse;
}

std::string packed(const std::vector<Index>& corners, ComponentType type) {
  std::string bytes;
  bytes.reserve(corners.size() * component_bytes(type));
  for (const Index corner : corners) {
    const auto value = static_cast<std::uint32_t>(corner);
    bytes.append(reinterpret_cast<const char*>(&value), component_bytes(type));
  }
  return bytes;
}

/// The largest value of a type restarts a primitive, so that it is not an index.
ComponentType index_type(std::size_t largest, bool may_be_u8) {
  if (may_be_u8 && largest < std::numeric_limits<std::uint8_t>::max()) return ComponentType::u8;
  if (largest < std::numeric_limits<std::uint16_t>::max()) return ComponentType::u16;
  return ComponentType::u32;
}

/// The members that an accessor over new bytes takes from the old one.
Json renewed(const Gltf& gltf, std::optional<std::size_t> old) {
  Json accessor = old ? gltf.json.at("accessors").at(*old) : Json::object();
  for (const char* stale : {"byteOffset", "normalized", "sparse", "min", "max"})
    accessor.erase(stale);
  return accessor;
}

template <class Elements>
Json float_accessor(Json accessor, const char* type, const Elements& elements, NewViews& views) {
  const std::string_view bytes(reinterpret_cast<const char*>(elements.data()),
                               elements.size() * sizeof elements[0]);
  accessor["bufferView"] = views.add(bytes, 0, kArrayBufferTarget);
  accessor["componentType"] = ComponentType::f32;
  accessor["count"] = elements.size();
  accessor["type"] = type;
  return accessor;
}

}  // namespace

std::size_t NewViews::add(std::string_view bytes, std::size_t stride, int target) {
  pad(document_->added, 4);
  Json view = {
      {"buffer", buffer_}, {"byteOffset", document_->added.size()}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  if (target != 0) view["target"] = target;
  document_->added += bytes;
  Json& views = document_->json["bufferViews"];
  views.push_back(std::move(view));
  return views.size() - 1;
}

Json grown_accessor(const Gltf& gltf, std::size_t accessor, const std::vector<Index>& copies,
                    NewViews& views) {
  throw_if_cancelled(gltf.stop);
  const Accessor& old = gltf.accessors[accessor];
  Json grown = gltf.json.at("accessors").at(accessor);
  grown["count"] = old.count + copies.size();
  if (old.view) {
    const std::size_t stride = (old.element_bytes + 3) / 4 * 4;
    grown["bufferView"] = views.add(dense_bytes(gltf, old, copies, stride),
                                    stride == old.element_bytes ? 0 : stride, kArrayBufferTarget);
    grown.erase("byteOffset");
  }
  if (old.sparse) grown["sparse"] = grown_sparse(gltf, old, grown["sparse"], copies, views);
  return grown;
}

Json index_accessor(const Gltf& gltf, std::optional<std::size_t> old,
                    const std::vector<Index>& corners, NewViews& views) {
  throw_if_cancelled(gltf.stop);
  const Index largest = *std::max_element(corners.begin(), corners.end());
  const bool had_u8 = old && gltf.accessors[*old].type == ComponentType::u8;
  const ComponentType type = index_type(as_size(largest), had_u8);
  Json accessor = renewed(gltf, old);
  accessor["bufferView"] = views.add(packed(corners, type), 0, kElementArrayBufferTarget);
  accessor["componentType"] = type;
  accessor["count"] = corners.size();
  accessor["type"] = "SCALAR";
  return accessor;
}

Json accessor_like(const Gltf& gltf, std::optional<std::size_t> old, const Json& other) {
  Json accessor = renewed(gltf, old);
  for (const char* part : {"bufferView", "componentType", "count", "type"})
    accessor[part] = other.at(part);
  return accessor;
}

void set_bounds(Json& accessor, std::string_view bytes, std::size_t stride,
                std::size_t components) {
  const auto type = accessor.at("componentType").get<ComponentType>();
  const auto value = [&](std::size_t element, std::size_t k) {
    return component_at(bytes.data() + element * stride + k * component_bytes(type), type);
  };
  std::vector<double> low(components);
  for (std::size_t k = 0; k < components; ++k) low[k] = value(0, k);
  std::vector<double> high = low;
  for (std::size_t i = 1; i < bytes.size() / stride; ++i)
    for (std::size_t k = 0; k < components; ++k) {
      low[k] = std::min(low[k], value(i, k));
      high[k] = std::max(high[k], value(i, k));
    }
  accessor["min"] = low;
  accessor["max"] = high;
}

Json texcoord_accessor(const Gltf& gltf, std::optional<std::size_t> old,
                       const std::vector<std::array<float, 2>>& uv, NewViews& views) {
  return float_accessor(renewed(gltf, old), "VEC2", uv, views);
}

Json tangent_accessor(const Gltf& gltf, std::optional<std::size_t> old,
                      const std::vector<std::array<float, 4>>& tangents, NewViews& views) {
  return float_accessor(renewed(gltf, old), "VEC4", tangents, views);
}

}  // namespace unwrapd::asset
