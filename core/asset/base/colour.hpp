#pragma once
// Colours of vertices.

#include <array>
#include <optional>
#include <vector>

#include "core/asset/base/words.hpp"

namespace unwrapd::asset {

/// Red, green and blue in sRGB, and alpha, each in [0, 1].
using Colour = std::array<float, 4>;

/// The next numbers, as many as there are of four, three at least; what is missing is no number.
std::optional<Colour> colour_in(Words words);

/// Gives the newest of so many vertices its colour, if it or one before it has any.
void add_colour(const std::optional<Colour>& colour, std::size_t vertices,
                std::vector<Colour>& colours);

/// Brings the colours of a file into [0, 1]. Files of text do not tell their unit: where a red,
/// green or blue is above 1, all values are bytes. What is no number becomes 1.
void to_shares(std::vector<Colour>& colours);

}  // namespace unwrapd::asset
