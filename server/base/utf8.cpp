#include "server/base/utf8.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace unwrapd::server {
namespace {

unsigned byte_at(std::string_view text, std::size_t at) {
  return static_cast<unsigned char>(text[at]);
}

bool continues(unsigned byte) { return (byte & 0xC0U) == 0x80U; }

/// The length of a character with this first byte; 0 for an invalid one.
std::size_t character_length(unsigned first) {
  if (first < 0x80U) return 1;
  if (first >= 0xC2U && first <= 0xDFU) return 2;  // C0 and C1 begin no shortest form
  if (first >= 0xE0U && first <= 0xEFU) return 3;
  if (first >= 0xF0U && first <= 0xF4U) return 4;
  return 0;
}

/// The second byte has a smaller range after four of the first ones (RFC 3629, 4).
bool may_follow(unsigned first, unsigned second) {
  if (first == 0xE0U) return second >= 0xA0U;
  if (first == 0xEDU) return second < 0xA0U;
  if (first == 0xF0U) return second >= 0x90U;
  if (first == 0xF4U) return second < 0x90U;
  return true;
}

bool is_control(unsigned byte) { return byte < 0x20U || byte == 0x7FU; }

/// Line separators, and marks of direction (Unicode 15, 23.2).
constexpr auto kHiddenMarks =
    std::to_array<std::string_view>({"\u2028", "\u2029", "\u202A", "\u202B", "\u202C", "\u202D",
                                     "\u202E", "\u2066", "\u2067", "\u2068", "\u2069"});

/// A control character of two bytes, U+0080 to U+009F.
bool has_wide_control(std::string_view text) {
  for (std::size_t at = text.find('\xC2'); at != std::string_view::npos;
       at = text.find('\xC2', at + 1))
    if (byte_at(text, at + 1) < 0xA0U) return true;
  return false;
}

}  // namespace

bool is_utf8_text(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const unsigned first = byte_at(text, at);
    const std::size_t length = character_length(first);
    if (length == 0 || text.size() - at < length) return false;
    if (length > 1 && !may_follow(first, byte_at(text, at + 1))) return false;
    for (std::size_t k = 1; k < length; ++k)
      if (!continues(byte_at(text, at + k))) return false;
    at += length;
  }
  return true;
}

bool is_plain_line(std::string_view text) {
  if (!is_utf8_text(text) || has_wide_control(text)) return false;
  const auto contains = [&](std::string_view mark) { return text.find(mark) != text.npos; };
  return std::ranges::none_of(text,
                              [](char c) { return is_control(static_cast<unsigned char>(c)); }) &&
         std::ranges::none_of(kHiddenMarks, contains);
}

std::size_t count_characters(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return !continues(static_cast<unsigned char>(c)); }));
}

std::string_view within_bytes(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && continues(byte_at(text, most))) --most;
  return text.substr(0, most);
}

}  // namespace unwrapd::server
