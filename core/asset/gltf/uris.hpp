#pragma once
// The URIs of buffers and images.

#include <stop_token>
#include <string>
#include <string_view>

#include "core/asset/gltf/json.hpp"

namespace unwrapd::asset {

/// The text with its escapes (%20) as the bytes that they stand for.
std::string percent_decoded(std::string_view uri);

/// The bytes of a data URI. Throws Error{malformed_gltf}, Error{cancelled}.
std::string data_uri_bytes(const Node& uri, const std::stop_token& stop);

/// Whether a path leads below its folder: it has no scheme, no parent and no odd characters.
bool is_plain_relative(std::string_view path);

}  // namespace unwrapd::asset
