#pragma once
// Base64 (RFC 4648, section 4) as data URIs use it.

#include <optional>
#include <string>
#include <string_view>

namespace unwrapd::asset {

/// Empty when text is not base64: a foreign character, padding elsewhere than at the end.
/// Missing padding is accepted.
std::optional<std::string> base64_decoded(std::string_view text);

void append_base64(std::string& text, std::string_view bytes);

}  // namespace unwrapd::asset
