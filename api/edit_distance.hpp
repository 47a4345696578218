#pragma once
// How far a mistyped word is from one that was meant.

#include <cstddef>
#include <string_view>

namespace unwrapd::api {

/// The number of letters that are added, left out or changed to turn a into b (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace unwrapd::api
