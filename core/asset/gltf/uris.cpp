#include "core/asset/gltf/uris.hpp"

#include <algorithm>
#include <optional>

#include "core/asset/base/base64.hpp"
#include "core/base/lower_case.hpp"

namespace unwrapd::asset {
namespace {

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char lower = lower_letter(c);
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
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

}  // namespace

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

}  // namespace unwrapd::asset
