#include "client/printable.hpp"

#include <cstddef>

namespace unwrapd::client {

std::string printable(std::string text) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = static_cast<unsigned char>(text[k]);
    const bool is_c1 = k > 0 && text[k - 1] == '\xC2' && byte >= 0x80 && byte < 0xA0;
    if (byte < 0x20 || byte == 0x7F) text[k] = '?';
    if (is_c1) text[k - 1] = text[k] = '?';
  }
  return text;
}

}  // namespace unwrapd::client
