// The buffers of a document. Bytes come from the GLB's chunk, from data URIs and from the parts of
// the request; every other URI is refused, and nothing is ever opened.
#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "core/asset/base64.hpp"
#include "core/asset/gltf_steps.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::string_view kDataScheme = "data:";

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const int lower = std::tolower(static_cast<unsigned char>(c));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() && hex_value(uri[i + 1]) >= 0 &&
                        hex_value(uri[i + 2]) >= 0;
    text += escape ? static_cast<char>(hex_value(uri[i + 1]) * 16 + hex_value(uri[i + 2])) : uri[i];
    if (escape) i += 2;
  }
  return text;
}

bool has_scheme(std::string_view uri) {
  const std::size_t end = uri.find_first_of(":/?#");
  return end != std::string_view::npos && uri[end] == ':';
}

bool has_parent_segment(std::string_view path) {
  while (true) {
    const std::size_t slash = path.find('/');
    if (path.substr(0, slash) == "..") return true;
    if (slash == std::string_view::npos) return false;
    path.remove_prefix(slash + 1);
  }
}

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

std::string data_uri_bytes(const Node& uri, const std::stop_token& stop) {
  const std::string& text = uri.text();
  const std::size_t comma = text.find(',');
  const std::string_view head = std::string_view(text).substr(0, comma);
  std::optional<std::string> bytes;
  if (comma != std::string::npos && head.ends_with(";base64"))
    bytes = base64_decoded(std::string_view(text).substr(comma + 1), stop);
  else if (comma != std::string::npos)  // RFC 2397: percent-encoded
    bytes = percent_decoded(std::string_view(text).substr(comma + 1));
  if (!bytes)
    fail(ErrorCode::malformed_gltf, uri.place(),
         "the data URI has no data, or is not valid base64; export the asset again");
  return std::move(*bytes);
}

bool is_plain_relative(std::string_view path) {
  const bool odd = std::any_of(path.begin(), path.end(), [](char c) {
    return c == '\\' || static_cast<unsigned char>(c) < 0x20;
  });
  return !path.empty() && !odd && path.front() != '/' && !has_scheme(path) &&
         !has_parent_segment(path);
}

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

}  // namespace unwrapd::asset
