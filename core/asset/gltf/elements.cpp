#include "core/asset/gltf/elements.hpp"

#include <algorithm>

#include "core/asset/base/bytes.hpp"

namespace unwrapd::asset {
namespace {

/// The value of a normalised integer (glTF 2.0, section 3.11).
double normalized(double value, ComponentType type) {
  switch (type) {
    case ComponentType::i8:
      return std::max(value / 127, -1.0);
    case ComponentType::u8:
      return value / 255;
    case ComponentType::i16:
      return std::max(value / 32767, -1.0);
    case ComponentType::u16:
      return value / 65535;
    case ComponentType::u32:
    case ComponentType::f32:
      break;
  }
  return value;
}

}  // namespace

double component_at(const char* bytes, ComponentType type) {
  switch (type) {
    case ComponentType::i8:
      return load<std::int8_t>(bytes);
    case ComponentType::u8:
      return load<std::uint8_t>(bytes);
    case ComponentType::i16:
      return load<std::int16_t>(bytes);
    case ComponentType::u16:
      return load<std::uint16_t>(bytes);
    case ComponentType::u32:
      return load<std::uint32_t>(bytes);
    case ComponentType::f32:
      break;
  }
  return static_cast<double>(load<float>(bytes));
}

Elements::Elements(const Gltf& gltf, std::size_t accessor)
    : gltf_(&gltf), accessor_(&gltf.accessors[accessor]) {
  if (!accessor_->sparse) return;
  for (std::size_t k = 0; k < accessor_->sparse->count; ++k)
    replaced_.emplace(sparse_index(gltf, *accessor_->sparse, k), sparse_value(gltf, *accessor_, k));
}

const char* Elements::at(std::size_t element) const {
  if (!replaced_.empty())
    if (const auto found = replaced_.find(element); found != replaced_.end()) return found->second;
  return accessor_->view ? dense_element(*gltf_, *accessor_, element) : nullptr;
}

std::size_t Elements::unsigned_at(std::size_t element) const {
  const char* bytes = at(element);
  return bytes == nullptr ? 0 : load_unsigned(bytes, component_bytes(accessor_->type));
}

double Elements::component(const char* bytes, std::size_t k) const {
  const double value = component_at(bytes + k * component_bytes(accessor_->type), accessor_->type);
  return accessor_->normalized ? normalized(value, accessor_->type) : value;
}

Vec3 Elements::vec3_at(std::size_t element) const {
  const char* bytes = at(element);
  if (bytes == nullptr) return Vec3::Zero();
  return {component(bytes, 0), component(bytes, 1), component(bytes, 2)};
}

double Elements::fourth_at(std::size_t element) const {
  const char* bytes = at(element);
  return bytes == nullptr ? 0 : component(bytes, 3);
}

double Elements::component_of(std::size_t element, std::size_t k) const {
  const char* bytes = at(element);
  return bytes == nullptr ? 0 : component(bytes, k);
}

Vec2 Elements::vec2_at(std::size_t element) const {
  const char* bytes = at(element);
  if (bytes == nullptr) return Vec2::Zero();
  return {component(bytes, 0), component(bytes, 1)};
}

}  // namespace unwrapd::asset
