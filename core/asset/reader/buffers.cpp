// The buffers of a document. Bytes come from the GLB's chunk, from data URIs and from the parts of
// the request; every other URI is refused, and nothing is ever opened.
#include <algorithm>
#include <array>
#include <optional>

#include "core/asset/gltf/extensions.hpp"
#include "core/asset/gltf/uris.hpp"
#include "core/asset/reader/steps.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::reader {
namespace {

constexpr std::string_view kDataScheme = "data:";

/// The part of the request that a URI names; end() if there is none.
auto part_of(const std::string& uri, const Input& input) {
  const auto part = input.buffers.find(uri);
  return part != input.buffers.end() ? part : input.buffers.find(percent_decoded(uri));
}

std::string external_bytes(const Node& uri, const Input& input) {
  const std::string decoded = percent_decoded(uri.text());
  if (!is_plain_relative(decoded))
    fail(ErrorCode::external_uri, uri.place(),
         "the server opens no files or addresses; embed the buffer, or send it as a part of the "
         "request under a plain relative name");
  const auto part = part_of(uri.text(), input);
  if (part == input.buffers.end())
    fail(ErrorCode::missing_buffer, uri.place(),
         "the buffer \"" + uri.text() +
             "\" was not sent; add it as a part of the request with this file name, or send a GLB");
  return std::string(part->second);
}

constexpr std::array<std::string_view, 2> kMeshopt = {"EXT_meshopt_compression",
                                                      "KHR_meshopt_compression"};

/// Whether a buffer is only the fallback of meshopt's views: it is marked so, or has no source in a
/// document that uses meshopt. Its bytes are not needed.
bool is_meshopt_fallback(const Node& buffer, bool has_source, bool uses_meshopt) {
  if (const auto extensions = buffer.find("extensions"))
    for (const std::string_view name : kMeshopt)
      if (const auto meshopt = extensions->find(name); meshopt && meshopt->flag("fallback"))
        return true;
  return !has_source && uses_meshopt;
}

void cut_to_length(std::string& bytes, const Node& buffer) {
  const Node length = buffer.at("byteLength");
  if (length.number() > bytes.size())
    fail(ErrorCode::malformed_gltf, length.place(),
         "the buffer has only " + std::to_string(bytes.size()) +
             " bytes, fewer than it states; send all of it");
  bytes.resize(length.number());
}

std::string buffer_bytes(const Node& buffer, std::string_view bin, const Input& input) {
  std::string bytes;
  const auto uri = buffer.find("uri");
  if (uri) {
    bytes = uri->text().starts_with(kDataScheme) ? data_uri_bytes(*uri, input.stop)
                                                 : external_bytes(*uri, input);
  } else if (bin.data() != nullptr) {
    bytes = bin;
  } else {
    fail(ErrorCode::missing_buffer, buffer.place(),
         "the buffer has no uri and the file has no binary chunk for it; export the asset again");
  }
  cut_to_length(bytes, buffer);
  return bytes;
}

}  // namespace

void resolve_buffers(Gltf& gltf, std::string_view bin, const Input& input) {
  const auto list = Node(gltf.json).find("buffers");
  const std::size_t count = list ? list->array_size() : 0;
  const bool uses_meshopt = std::any_of(kMeshopt.begin(), kMeshopt.end(),
                                        [&](auto name) { return uses_extension(gltf.json, name); });
  for (std::size_t i = 0; i < count; ++i) {
    throw_if_cancelled(gltf.stop);
    const Node buffer = list->at(i);
    buffer.expect_object();
    const std::string_view own_bin = i == 0 ? bin : std::string_view();
    const bool has_source = buffer.find("uri") || own_bin.data() != nullptr;
    gltf.buffers.push_back(is_meshopt_fallback(buffer, has_source, uses_meshopt)
                               ? std::string()
                               : buffer_bytes(buffer, own_bin, input));
  }
}

void take_images(Gltf& gltf, const Input& input) {
  const auto images = gltf.json.find("images");
  if (input.buffers.empty() || images == gltf.json.end() || !images->is_array()) return;
  for (std::size_t i = 0; i < images->size(); ++i) {
    const Json& image = (*images)[i];
    const auto uri = image.is_object() ? image.find("uri") : image.end();
    if (uri == image.end() || !uri->is_string()) continue;
    const auto part = part_of(uri->get_ref<const std::string&>(), input);
    if (part != input.buffers.end()) gltf.sent_images.emplace(i, part->second);
  }
}

}  // namespace unwrapd::asset::reader
