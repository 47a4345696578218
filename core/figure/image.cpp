#include "core/figure/image.hpp"

#include <string_view>

namespace unwrapd::figure {
namespace {

constexpr std::string_view kDigits = "0123456789abcdef";

}  // namespace

std::string hex(const Rgb& colour) {
  std::string text = "#";
  for (const std::uint8_t part : colour) {
    text += kDigits[part / 16];
    text += kDigits[part % 16];
  }
  return text;
}

}  // namespace unwrapd::figure
