#pragma once
// The key of a kept thing, written from the very arguments of the function that makes it. A type
// says once, in describe(), what of it counts; it takes itself apart by a structured binding there,
// so that a field that is added does not compile until it is described, too.

#include <concepts>
#include <optional>
#include <ranges>
#include <span>
#include <type_traits>
#include <vector>

#include "core/base/shared_cache.hpp"
#include "core/mesh/surface_numbers.hpp"
#include "core/types/options.hpp"

namespace unwrapd {

/// Whether a value's bytes are all that it is.
template <typename T>
inline constexpr bool kIsPlain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <typename T, std::size_t n>
inline constexpr bool kIsPlain<std::array<T, n>> = kIsPlain<T>;
template <>
inline constexpr bool kIsPlain<Vec2> = true;
template <>
inline constexpr bool kIsPlain<Vec3> = true;

class CacheKey {
 public:
  /// core must outlive the fingerprint.
  explicit CacheKey(const SharedCache& core) : core_(core) {}

  /// What T's describe(Fingerprint&, const T&) adds; else a plain value, or a list or an optional
  /// of what can be added. Of a list that knows its digest, that is taken.
  template <typename T>
  CacheKey& add(const T& value) {
    if constexpr (requires { describe(*this, value); })
      describe(*this, value);
    else if constexpr (kIsPlain<T>)
      append(std::as_bytes(std::span(&value, 1)));
    else if constexpr (std::ranges::sized_range<T>)
      add_list(value);
    else
      add_optional(value);
    return *this;
  }

  /// Of all that was added.
  [[nodiscard]] Digest digest() const;

 private:
  void append(std::span<const std::byte> bytes);

  template <typename T>
  void add_optional(const std::optional<T>& value) {
    add(value.has_value());
    if (value) add(*value);
  }

  template <typename List>
  void add_list(const List& list) {
    add(std::ranges::size(list));
    if constexpr (requires { list.digest(); })
      if (add(list.digest().has_value()); list.digest()) return append(*list.digest());
    if constexpr (kIsPlain<std::ranges::range_value_t<List>>)
      add_bytes(std::as_bytes(std::span(std::ranges::data(list), std::ranges::size(list))));
    else
      for (const auto& item : list) add(item);
  }

  void add_bytes(std::span<const std::byte> bytes);

  const SharedCache& core_;
  std::vector<std::byte> bytes_;
};

/// A SharedList or ListView that knows the digest of its bytes, which are read once for all keys.
/// core: null where no key is made.
template <typename List>
List known_by_bytes(const SharedCache* core, const List& list) {
  if (core == nullptr) return list;
  return list.known_as(core->digest(std::as_bytes(std::span(list.data(), list.size()))));
}

inline void describe(CacheKey& key, const SeamPath& path) {
  const auto& [surface, vertices] = path;
  key.add(surface).add(vertices);
}

inline void describe(CacheKey& key, const TriMesh& mesh) {
  const auto& [positions, faces] = mesh;
  key.add(positions).add(faces);
}

inline void describe(CacheKey& key, const Surface& surface) {
  const auto& [mesh, part, name, corner_uv, materials, seam_avoid, texel_density, scale] = surface;
  key.add(mesh).add(part).add(name).add(corner_uv).add(materials);
  key.add(seam_avoid).add(texel_density).add(scale);
}

inline void describe(CacheKey& key, const SurfaceNumbers& surface) {
  const auto& [faces, vertex_count, part, name, corner_uv, materials] = surface;
  key.add(faces).add(vertex_count).add(part).add(name).add(corner_uv).add(materials);
}

}  // namespace unwrapd
