#pragma once
// What a mistyped word was meant to be.

#include <span>
#include <string>
#include <string_view>

namespace unwrapd::client {

/// The word that is nearest to `given` by api::edit_distance(), of several the first; none if that
/// takes more than two letters, or all of those given.
const std::string* nearest(std::string_view given, std::span<const std::string> words);

}  // namespace unwrapd::client
