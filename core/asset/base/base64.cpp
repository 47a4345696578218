#include "core/asset/base/base64.hpp"

#include <array>
#include <cstdint>

#include "core/asset/base/pace.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::string_view kAlphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kForeign = 0xff;

constexpr std::array<std::uint8_t, 256> inverse_alphabet() {
  std::array<std::uint8_t, 256> inverse{};
  inverse.fill(kForeign);
  for (std::size_t i = 0; i < kAlphabet.size(); ++i)
    inverse[static_cast<std::uint8_t>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  return inverse;
}

constexpr std::array<std::uint8_t, 256> kValueOf = inverse_alphabet();

std::string_view without_padding(std::string_view text) {
  for (int k = 0; k < 2 && text.ends_with('='); ++k) text.remove_suffix(1);
  return text;
}

}  // namespace

std::optional<std::string> base64_decoded(std::string_view text, const std::stop_token& stop) {
  text = without_padding(text);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int bit_count = 0;
  Pace pace(stop);
  for (const char c : text) {
    pace.add(1);
    const std::uint8_t value = kValueOf[static_cast<std::uint8_t>(c)];
    if (value == kForeign) return std::nullopt;
    bits = bits << 6 | value;
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes += static_cast<char>(bits >> bit_count & 0xff);
  }
  return bytes;
}

void append_base64(std::string& text, std::string_view bytes, const std::stop_token& stop) {
  Pace pace(stop);
  text.reserve(text.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    pace.add(1);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kAlphabet[bits >> (18 - 6 * k) & 63];
  }
}

std::string data_uri(std::string_view bytes, const std::stop_token& stop,
                     std::string_view media_type) {
  std::string uri = "data:" + std::string(media_type) + ";base64,";
  append_base64(uri, bytes, stop);
  return uri;
}

}  // namespace unwrapd::asset
