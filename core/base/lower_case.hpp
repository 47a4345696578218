#pragma once
// Lower case of ASCII letters, as formats and protocols mean it: the same in every locale. All
// other bytes stay.

#include <algorithm>
#include <string>
#include <string_view>

namespace unwrapd {

constexpr char lower_letter(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

inline std::string lower_case(std::string_view text) {
  std::string lowered(text);
  std::ranges::transform(lowered, lowered.begin(), lower_letter);
  return lowered;
}

}  // namespace unwrapd
