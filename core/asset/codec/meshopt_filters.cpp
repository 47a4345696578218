#include "core/asset/codec/meshopt_filters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace unwrapd::asset::codec {
namespace {

/// The normalised integer of a value in [-1, 1].
template <class Integer>
Integer quantised(double value) {
  return static_cast<Integer>(std::round(value * std::numeric_limits<Integer>::max()));
}

/// EXT_meshopt_compression, appendix B, filter 1.
template <class Integer>
void decode_octahedral_element(char* bytes) {
  std::array<Integer, 4> code;
  std::memcpy(code.data(), bytes, sizeof code);
  const double one =
      std::max(1.0, std::abs(static_cast<double>(code[2])));  // 0 only in damaged data
  double x = code[0] / one, y = code[1] / one;
  const double z = 1 - std::abs(x) - std::abs(y);
  const double folded = std::max(-z, 0.0);  // the lower half lies outside the square
  x -= x >= 0 ? folded : -folded;
  y -= y >= 0 ? folded : -folded;
  const double length = std::sqrt(x * x + y * y + z * z);
  code[0] = quantised<Integer>(x / length);
  code[1] = quantised<Integer>(y / length);
  code[2] = quantised<Integer>(z / length);
  std::memcpy(bytes, code.data(), sizeof code);
}

/// EXT_meshopt_compression, appendix B, filter 2.
void decode_quaternion(char* bytes) {
  std::array<std::int16_t, 4> code;
  std::memcpy(code.data(), bytes, sizeof code);
  const std::size_t largest = static_cast<std::uint16_t>(code[3]) & 3U;
  const double scale = std::sqrt(0.5) / (code[3] | 3);
  std::array<double, 3> rest;
  double squares = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    rest[k] = std::clamp(code[k] * scale, -1.0, 1.0);
    squares += rest[k] * rest[k];
  }
  code[largest] = quantised<std::int16_t>(std::sqrt(std::max(0.0, 1 - squares)));
  for (std::size_t k = 0; k < 3; ++k)
    code[(largest + 1 + k) % 4] = quantised<std::int16_t>(rest[k]);
  std::memcpy(bytes, code.data(), sizeof code);
}

}  // namespace

void decode_octahedral(std::span<char> bytes, std::size_t stride) {
  for (std::size_t at = 0; at + stride <= bytes.size(); at += stride)
    stride == 4 ? decode_octahedral_element<std::int8_t>(&bytes[at])
                : decode_octahedral_element<std::int16_t>(&bytes[at]);
}

void decode_quaternions(std::span<char> bytes) {
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) decode_quaternion(&bytes[at]);
}

}  // namespace unwrapd::asset::codec
