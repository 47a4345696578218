#pragma once
// A number as protocols, files and options write it: the same in every locale.

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace unwrapd {

/// The number that the whole text is, in decimal, without a plus sign or spaces. Nothing when it is
/// none, or does not fit.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

}  // namespace unwrapd
