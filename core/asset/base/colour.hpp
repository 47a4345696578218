#pragma once
// Colours of vertices.

#include <array>
#include <optional>
#include <vector>

#include "core/asset/base/words.hpp"

namespace unwrapd::asset {

/// Red, green and blue in sRGB, and alpha, each in [0, 1]; NaN where a file does not tell it.
using Colour = std::array<float, 4>;

/// The next numbers, as many as there are of four, three at least.
std::optional<Colour> colour_in(Words words);

/// Gives the newest of so many vertices its colour. The list stays empty until one has any.
void add_colour(const std::optional<Colour>& colour, std::size_t vertex_count,
                std::vector<Colour>& colours);

/// Channels in a unit that the file does not tell: shares of 1, or bytes.
using Untold = std::array<bool, 4>;

/// Brings the colours of a file into [0, 1]. Channels of an untold unit are bytes where one of
/// their values is above 2: red, green and blue together; alpha by its own, and then so are they.
void to_shares(std::vector<Colour>& colours, const Untold& untold = {true, true, true, true});

/// With 1 for what is not known.
Colour as_shown(const Colour& colour);

}  // namespace unwrapd::asset
