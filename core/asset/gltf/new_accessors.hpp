#pragma once
// Makes new accessors over new bytes. Each function returns the accessor's JSON, with the name and
// extras of the accessor that it replaces, if any.

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/asset/gltf/gltf.hpp"

namespace unwrapd::asset {

/// A document with one more buffer than its input: the last one, `added`.
struct PatchedDocument {
  Json json;
  std::string added;
  const Aside* aside = nullptr;  ///< members that are written in addition to json
};

/// Adds buffer views to a patched document, over its buffer `added`.
class NewViews {
 public:
  NewViews(PatchedDocument& document, std::size_t buffer) : document_(&document), buffer_(buffer) {}

  /// stride 0: tight. target 0: neither vertices nor indices. Returns the number of the view.
  std::size_t add(std::string_view bytes, std::size_t stride, int target);

 private:
  PatchedDocument* document_;
  std::size_t buffer_;
};

/// The accessor's elements, followed by copies of some of them; a sparse accessor stays sparse.
Json grown_accessor(const Gltf& gltf, std::size_t accessor, const std::vector<Index>& copies,
                    NewViews& views);

/// Triangle corners in the smallest type that holds them; 8 bits only if `old` had them.
Json index_accessor(const Gltf& gltf, std::optional<std::size_t> old,
                    const std::vector<Index>& corners, NewViews& views);

/// An accessor with the name and extras of `old`, over the bytes of another one.
Json accessor_like(const Gltf& gltf, std::optional<std::size_t> old, const Json& other);

/// Sets min and max over elements of `components` each, `stride` bytes apart, as they are stored.
void set_bounds(Json& accessor, std::string_view bytes, std::size_t stride, std::size_t components);

Json texcoord_accessor(const Gltf& gltf, std::optional<std::size_t> old,
                       const std::vector<std::array<float, 2>>& uv, NewViews& views);

Json tangent_accessor(const Gltf& gltf, std::optional<std::size_t> old,
                      const std::vector<std::array<float, 4>>& tangents, NewViews& views);

}  // namespace unwrapd::asset
