// Buffer views become streams of meshoptimizer's codecs (Kapoulkine), which are exact for any
// bytes: vertices by the deltas of each byte of an element, triangles by the edges they share with
// those before. What is left of a view is its size in a second buffer that has no bytes.
#include <meshoptimizer.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include "core/asset/bytes.hpp"
#include "core/asset/compress.hpp"
#include "core/asset/gltf_steps.hpp"
#include "core/asset/references.hpp"

namespace unwrapd::asset {
namespace {

constexpr const char* kExtension = "EXT_meshopt_compression";
constexpr std::size_t kMaxStride = 256;

enum class Use { none, vertices, indices, triangles, mixed };

/// What the accessors over a view are.
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
    Json copy = document;
    copy.erase("accessors");
    for_each_view_reference(copy, [&](Json& view) {
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

void require_extension(Json& document) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    Json& names = document[list];
    if (std::find(names.begin(), names.end(), kExtension) == names.end())
      names.push_back(kExtension);
  }
}

}  // namespace

void compress_views(Json& document, std::string& bytes) {
  if (!document.contains("meshes") || !document.contains("accessors")) return;
  const Uses uses(document);
  std::string packed;
  std::size_t unpacked = 0;
  for (std::size_t i = 0; i < document["bufferViews"].size(); ++i) {
    Json& view = document["bufferViews"][i];
    const std::size_t length = number(view, "byteLength");
    const auto plain = std::string_view(bytes).substr(number(view, "byteOffset"), length);
    const std::optional<Encoded> encoded = encode(uses.of(i), view, plain);
    pad(packed, 4);
    const std::size_t at = packed.size();
    packed += encoded ? std::string_view(encoded->bytes) : plain;
    if (!encoded) {
      view["byteOffset"] = at;
      continue;
    }
    unpacked = (unpacked + 3) / 4 * 4;
    view["buffer"] = 1;
    view["byteOffset"] = unpacked;
    unpacked += length;
    view["extensions"][kExtension] = {{"buffer", 0},
                                      {"byteOffset", at},
                                      {"byteLength", encoded->bytes.size()},
                                      {"byteStride", encoded->stride},
                                      {"mode", encoded->mode},
                                      {"count", length / encoded->stride}};
  }
  if (unpacked == 0) return;
  bytes = std::move(packed);
  document["buffers"].push_back(
      {{"byteLength", unpacked}, {"extensions", {{kExtension, {{"fallback", true}}}}}});
  require_extension(document);
}

}  // namespace unwrapd::asset
