// Buffer views become streams of meshoptimizer's codecs (Kapoulkine), which are exact for any
// bytes: vertices by the deltas of each byte of an element, triangles by the edges they share with
// those before. What is left of a view is its size in a second buffer that has no bytes.
#include <meshoptimizer.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/asset/base/base64.hpp"
#include "core/asset/base/bytes.hpp"
#include "core/asset/codec/compress.hpp"
#include "core/asset/gltf/references.hpp"
#include "core/asset/gltf/runs.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::codec {
namespace {

constexpr std::size_t kMaxStride = 256;

enum class Use { none, vertices, indices, triangles, mixed };

/// The accessors over a view, by their kind.
struct ViewUse {
  Use use = Use::none;
  std::size_t element_bytes = 0;
};

std::size_t number(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? 0 : found->get<std::size_t>();
}

std::size_t element_bytes(const Json& accessor) {
  const std::string type = accessor.at("type").get<std::string>();
  const std::size_t count = type == "SCALAR" ? 1 : type.starts_with("VEC") ? type[3] - '0' : 0;
  return count * component_bytes(accessor.at("componentType").get<ComponentType>());
}

class Uses {
 public:
  explicit Uses(const Json& document) : document_(document) {
    of_view_.resize(document.at("bufferViews").size());
    std::vector<std::size_t> left =
        count_accessor_references(document, document.at("accessors").size());
    for (const Json& mesh : document.at("meshes"))
      for (const Json& primitive : mesh.at("primitives")) add_primitive(primitive, left);
    for (std::size_t a = 0; a < left.size(); ++a)
      if (left[a] > 0) add(a, Use::mixed);  // animations and skins
    for_each_other_view_reference(document, [&](const Json& view) {
      of_view_[view.get<std::size_t>()] = {Use::mixed, 0};
    });
  }

  [[nodiscard]] const ViewUse& of(std::size_t view) const { return of_view_[view]; }

 private:
  void add_primitive(const Json& primitive, std::vector<std::size_t>& left) {
    const auto take = [&](const Json& accessor, Use use) {
      --left[accessor.get<std::size_t>()];
      add(accessor.get<std::size_t>(), use);
    };
    for (const auto& [semantic, accessor] : primitive.at("attributes").items())
      take(accessor, Use::vertices);
    if (const auto targets = primitive.find("targets"); targets != primitive.end())
      for (const Json& target : *targets)
        for (const auto& [semantic, accessor] : target.items()) take(accessor, Use::vertices);
    const bool is_list = !primitive.contains("mode") || primitive.at("mode") == Mode::triangles;
    if (primitive.contains("indices"))
      take(primitive.at("indices"), is_list ? Use::triangles : Use::indices);
  }

  void add(std::size_t accessor, Use use) {
    const Json& json = document_.at("accessors").at(accessor);
    if (const auto sparse = json.find("sparse"); sparse != json.end())
      for (const char* part : {"indices", "values"})
        of_view_[sparse->at(part).at("bufferView").get<std::size_t>()] = {Use::mixed, 0};
    if (!json.contains("bufferView")) return;
    const auto view = json.at("bufferView").get<std::size_t>();
    const std::size_t bytes = element_bytes(json);
    ViewUse& known = of_view_[view];
    const bool is_whole =
        use == Use::vertices || (number(json, "byteOffset") == 0 &&
                                 bytes * number(json, "count") ==
                                     number(document_.at("bufferViews").at(view), "byteLength") &&
                                 (use != Use::triangles || number(json, "count") % 3 == 0));
    if (known.use == Use::none && is_whole)
      known = {use, bytes};
    else if (known.use != use || !is_whole ||
             (known.element_bytes != bytes && use != Use::vertices))
      known.use = Use::mixed;
  }

  const Json& document_;
  std::vector<ViewUse> of_view_;
};

struct Encoded {
  std::string bytes;
  std::size_t stride = 0;
  const char* mode = "";
};

template <class Encode>
std::string encoded_within(std::size_t bound, Encode encode) {
  std::string bytes(bound, '\0');
  bytes.resize(encode(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size()));
  return bytes;
}

std::optional<Encoded> encode_vertices(std::string_view plain, std::size_t stride) {
  if (stride == 0 || stride % 4 != 0 || stride > kMaxStride || plain.size() % stride != 0)
    return std::nullopt;
  const std::size_t count = plain.size() / stride;
  return Encoded{encoded_within(meshopt_encodeVertexBufferBound(count, stride),
                                [&](unsigned char* to, std::size_t size) {
                                  return meshopt_encodeVertexBuffer(to, size, plain.data(), count,
                                                                    stride);
                                }),
                 stride, "ATTRIBUTES"};
}

std::optional<Encoded> encode_indices(std::string_view plain, std::size_t stride,
                                      bool as_triangles) {
  if (stride != 2 && stride != 4) return std::nullopt;
  std::vector<unsigned> indices(plain.size() / stride);
  unsigned most = 0;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    indices[k] = static_cast<unsigned>(load_unsigned(plain.data() + k * stride, stride));
    most = std::max(most, indices[k]);
  }
  const std::size_t count = indices.size(), vertices = std::size_t{most} + 1;
  if (as_triangles)
    return Encoded{encoded_within(meshopt_encodeIndexBufferBound(count, vertices),
                                  [&](unsigned char* to, std::size_t size) {
                                    return meshopt_encodeIndexBuffer(to, size, indices.data(),
                                                                     count);
                                  }),
                   stride, "TRIANGLES"};
  return Encoded{encoded_within(meshopt_encodeIndexSequenceBound(count, vertices),
                                [&](unsigned char* to, std::size_t size) {
                                  return meshopt_encodeIndexSequence(to, size, indices.data(),
                                                                     count);
                                }),
                 stride, "INDICES"};
}

std::optional<Encoded> encode(const ViewUse& use, const Json& view, std::string_view plain) {
  if (plain.empty()) return std::nullopt;
  const std::size_t given = number(view, "byteStride");
  if (use.use == Use::vertices)
    return encode_vertices(plain, given != 0 ? given : use.element_bytes);
  if (use.use == Use::indices || use.use == Use::triangles)
    return encode_indices(plain, use.element_bytes, use.use == Use::triangles);
  return std::nullopt;
}

void list_extension(Json& document, const MeshoptStyle& style) {
  document["extensionsUsed"].push_back(style.name);
  if (!style.with_fallback) document["extensionsRequired"].push_back(style.name);
}

/// The buffer of the uncompressed views. It has bytes only if readers without the extension shall
/// read it.
Json fallback_buffer(const std::string& plain, const MeshoptStyle& style,
                     const std::stop_token& stop) {
  Json buffer = {{"byteLength", plain.size()},
                 {"extensions", {{style.name, {{"fallback", true}}}}}};
  if (style.with_fallback) buffer["uri"] = data_uri(plain, stop);
  return buffer;
}

/// The views of one range; no view of another range overlaps it.
struct Range {
  std::size_t begin = 0, end = 0;
  std::vector<std::size_t> views;
};

/// The ranges that are not contained in others.
std::vector<Range> separate_ranges(const Json& views) {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<std::size_t>> by_range;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::size_t begin = number(views[i], "byteOffset");
    by_range[{begin, begin + number(views[i], "byteLength")}].push_back(i);
  }
  std::vector<Range> separate;
  std::size_t reached = 0;
  for (auto range = by_range.begin(); range != by_range.end(); ++range) {
    const auto [begin, end] = range->first;
    const auto next = std::next(range);
    if (begin >= reached && (next == by_range.end() || next->first.first >= end))
      separate.push_back({begin, end, std::move(range->second)});
    reached = std::max(reached, end);
  }
  return separate;
}

/// The kind of all views of a range.
ViewUse common_use(const Uses& uses, const Json& views, const Range& range) {
  const std::size_t first = range.views.front();
  for (const std::size_t i : range.views)
    if (uses.of(i).use != uses.of(first).use ||
        uses.of(i).element_bytes != uses.of(first).element_bytes ||
        number(views[i], "byteStride") != number(views[first], "byteStride"))
      return {Use::mixed, 0};
  return uses.of(first);
}

class Packer {
 public:
  Packer(Json& document, std::string_view bytes, const MeshoptStyle& style)
      : views_(document["bufferViews"]), bytes_(bytes), style_(style), uses_(document) {}

  /// The compressed bytes, and those of views that stay uncompressed.
  std::string pack(const std::stop_token& stop) {
    std::vector<char> is_packed(views_.size(), 0);
    for (const Range& range : separate_ranges(views_)) {
      throw_if_cancelled(stop);
      const std::string_view plain = bytes_.substr(range.begin, range.end - range.begin);
      const std::optional<Encoded> encoded =
          encode(common_use(uses_, views_, range), views_[range.views.front()], plain);
      if (!encoded) continue;
      add(range, plain, *encoded);
      for (const std::size_t i : range.views) is_packed[i] = 1;
    }
    keep_plain(is_packed);
    return std::move(packed_);
  }

  [[nodiscard]] const std::string& unpacked() const { return unpacked_; }

 private:
  void add(const Range& range, std::string_view plain, const Encoded& encoded) {
    pad(packed_, 4);
    pad(unpacked_, 4);
    for (const std::size_t i : range.views) {
      views_[i]["buffer"] = 1;
      views_[i]["byteOffset"] = unpacked_.size();
      views_[i]["extensions"][style_.name] = {{"buffer", 0},
                                              {"byteOffset", packed_.size()},
                                              {"byteLength", encoded.bytes.size()},
                                              {"byteStride", encoded.stride},
                                              {"mode", encoded.mode},
                                              {"count", plain.size() / encoded.stride}};
    }
    packed_ += encoded.bytes;
    unpacked_ += plain;
  }

  /// Copies the views that are not compressed, in the same positions relative to each other if they
  /// overlap.
  void keep_plain(const std::vector<char>& is_packed) {
    std::vector<Run> runs;
    for (std::size_t i = 0; i < is_packed.size(); ++i) {
      const std::size_t begin = number(views_[i], "byteOffset");
      if (is_packed[i] == 0) runs.push_back({0, begin, begin + number(views_[i], "byteLength"), 0});
    }
    runs = merged(std::move(runs));
    append_runs(packed_, {bytes_}, runs);
    for (std::size_t i = 0; i < is_packed.size(); ++i) {
      if (is_packed[i] != 0) continue;
      const std::size_t offset = number(views_[i], "byteOffset");
      const Run& run = run_of(runs, 0, offset);
      views_[i]["byteOffset"] = run.target + (offset - run.begin);
    }
  }

  Json& views_;
  std::string_view bytes_;
  const MeshoptStyle& style_;
  Uses uses_;
  std::string packed_, unpacked_;
};

}  // namespace

void compress_views(Json& document, std::string& bytes, const MeshoptStyle& style,
                    const std::stop_token& stop) {
  if (!document.contains("meshes") || !document.contains("accessors")) return;
  Packer packer(document, bytes, style);
  bytes = packer.pack(stop);
  if (packer.unpacked().empty()) return;
  document["buffers"].push_back(fallback_buffer(packer.unpacked(), style, stop));
  list_extension(document, style);
}

}  // namespace unwrapd::asset::codec
