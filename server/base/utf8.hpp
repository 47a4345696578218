#pragma once
// Whether bytes are text. What is not must never reach JSON, a row or a log as text.

#include <cstddef>
#include <string_view>

namespace unwrapd::server {

/// Well-formed UTF-8: shortest forms, no surrogates, nothing beyond U+10FFFF (RFC 3629).
bool is_utf8_text(std::string_view text);

/// Such text in one line that lists can show: without control characters, line separators, and
/// marks that turn the direction of what follows.
bool is_plain_line(std::string_view text);

/// The number of characters (code points) of well-formed UTF-8.
std::size_t count_characters(std::string_view text);

/// The beginning of text in at most so many bytes, which ends with a whole character.
std::string_view within_bytes(std::string_view text, std::size_t most);

}  // namespace unwrapd::server
