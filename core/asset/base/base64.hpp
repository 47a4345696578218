#pragma once
// Base64 (RFC 4648, section 4) as data URIs use it.

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

namespace unwrapd::asset {

/// Empty if text is not base64: a foreign character, or padding anywhere but at the end. Missing
/// padding is accepted. Throws Error{cancelled}, as append_base64() does.
std::optional<std::string> base64_decoded(std::string_view text, const std::stop_token& stop = {});

void append_base64(std::string& text, std::string_view bytes, const std::stop_token& stop = {});

/// The data URI of these bytes.
std::string data_uri(std::string_view bytes, const std::stop_token& stop = {},
                     std::string_view media_type = "application/octet-stream");

}  // namespace unwrapd::asset
