#pragma once
// Writing for pictures that no text renderer ever sees.

#include <string_view>
#include <vector>

#include "core/figure/colour_scale.hpp"
#include "core/figure/raster.hpp"

namespace unwrapd::figure {

inline constexpr double kDigitHeight = 0.72;  ///< of the font's

struct Pen {
  Rgb colour;
  double width = 0.95;  ///< 1/10.5 of the font's height
};

/// Writes lower-case letters, digits, '/', '.' and spaces; anything else is left blank. `start` is
/// where the baseline begins and `size` the height of the font, of which digits take 0.72, pixels.
void append_text(std::vector<FlatTriangle>& drawing, std::string_view text, const Vec2& start,
                 double size, const Pen& pen = {.colour = kInk});

/// The width of the text at this size, pixels.
double text_width(std::string_view text, double size);

}  // namespace unwrapd::figure
