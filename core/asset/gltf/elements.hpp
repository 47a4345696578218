#pragma once
// The elements of one accessor in any encoding: dense, sparse, quantised, or all zero.

#include <unordered_map>

#include "core/asset/gltf/gltf.hpp"

namespace unwrapd::asset {

/// The component at `bytes` as it is stored; little-endian, any alignment.
double component_at(const char* bytes, ComponentType type);

class Elements {
 public:
  Elements(const Gltf& gltf, std::size_t accessor);  ///< both must outlive this

  /// The bytes of an element; null means zeros.
  [[nodiscard]] const char* at(std::size_t element) const;

  [[nodiscard]] std::size_t unsigned_at(std::size_t element) const;  ///< of an unsigned scalar
  [[nodiscard]] Vec3 vec3_at(std::size_t element) const;  ///< normalised if the accessor says so
  [[nodiscard]] double fourth_at(std::size_t element) const;  ///< of a vector of four, likewise
  [[nodiscard]] Vec2 vec2_at(std::size_t element) const;      ///< likewise
  /// Component k of an element, likewise.
  [[nodiscard]] double component_of(std::size_t element, std::size_t k) const;

 private:
  [[nodiscard]] double component(const char* bytes, std::size_t k) const;

  const Gltf* gltf_;
  const Accessor* accessor_;
  std::unordered_map<std::size_t, const char*> replaced_;
};

}  // namespace unwrapd::asset
