#pragma once
// What a mistyped word was meant to be.

#include <span>
#include <string>
#include <string_view>

namespace unwrapd::client {

/// The word that becomes `given` by the fewest letters added, left out or changed (Levenshtein
/// 1966), of several the first; none if that takes more than two, or all of its letters.
const std::string* nearest(std::string_view given, std::span<const std::string> words);

}  // namespace unwrapd::client
