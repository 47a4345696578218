#pragma once
// Colours of vertices.

#include <array>
#include <optional>
#include <vector>

#include "core/asset/base/words.hpp"

namespace unwrapd::asset {

/// Red, green and blue in sRGB, and alpha, each in [0, 1]; NaN where a file does not tell it.
using Colour = std::array<float, 4>;

/// Reads three numbers and an optional fourth, the alpha; none if there are fewer than three.
std::optional<Colour> colour_in(Words words);

/// Appends the colour of the last of vertex_count vertices, at least 1; earlier vertices without
/// one become NaN. The list stays empty until a vertex has a colour.
void add_colour(const std::optional<Colour>& colour, std::size_t vertex_count,
                std::vector<Colour>& colours);

/// Of each channel, whether the file does not tell its unit.
using UnitUnknown = std::array<bool, 4>;

/// Scales colours to [0, 1]. Channels of unknown unit hold bytes if a value is above 2, otherwise
/// shares. Red, green and blue are decided together, and are bytes as well if alpha is; alpha is
/// decided by its own values.
void normalize_colours(std::vector<Colour>& colours,
                       const UnitUnknown& unit_unknown = {true, true, true, true});

/// With 1 for what is not known.
Colour as_shown(const Colour& colour);

}  // namespace unwrapd::asset
