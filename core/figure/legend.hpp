#pragma once
// Below a layout: the colour bar, what it means, and the colour of flipped triangles. Where all of
// it lies, in units of which the page's side has kPageUnits; x to the right, y down from the page's
// upper edge.

#include <string_view>
#include <vector>

#include "core/figure/colour_scale.hpp"

namespace unwrapd::figure {

inline constexpr int kPageUnits = 4096;
inline constexpr int kLegendUnits = 320;  ///< height of what lies below the page

struct Swatch {
  double x = 0, y = 0, width = 0, height = 0;
  Rgb colour = {};
};

struct Label {
  double x = 0, y = 0;  ///< start of the baseline, or its middle
  double size = 0;      ///< height of the font
  std::string_view text;
  bool is_centred = false;
};

struct Legend {
  std::vector<Swatch> swatches;
  std::vector<Label> labels;
};

Legend legend_of(const ColourScale& scale);

}  // namespace unwrapd::figure
