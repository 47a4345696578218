#include "server/base/utf8.hpp"

#include <algorithm>
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

std::string_view within_bytes(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && continues(byte_at(text, most))) --most;
  return text.substr(0, most);
}

}  // namespace unwrapd::server
