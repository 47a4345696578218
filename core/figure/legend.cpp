#include "core/figure/legend.hpp"

#include <algorithm>

namespace unwrapd::figure {
namespace {

constexpr double kTitleX = 96, kTitleSize = 116, kTextSize = 84;
constexpr double kBarX = 1472, kBarWidth = 1820, kFlippedX = 3744, kFlippedWidth = 252;
constexpr double kBarTop = kPageUnits + 72, kBarHeight = 96;
constexpr double kTitleBaseline = kPageUnits + 152, kBaseline = kPageUnits + 262;

}  // namespace

Legend legend_of(const ColourScale& scale) {
  Legend legend;
  const double width = kBarWidth / std::max(4.0, static_cast<double>(scale.colours.size()));
  for (std::size_t k = 0; k < scale.colours.size(); ++k)
    legend.swatches.push_back(
        {kBarX + static_cast<double>(k) * width, kBarTop, width, kBarHeight, scale.colours[k]});
  legend.swatches.push_back({kFlippedX, kBarTop, kFlippedWidth, kBarHeight, kFlippedColour});
  legend.labels = {{kTitleX, kTitleBaseline, kTitleSize, scale.title},
                   {kTitleX, kBaseline, kTextSize, scale.caption},
                   {kFlippedX, kBaseline, kTextSize, "flipped"}};
  for (const Tick& tick : scale.ticks) {
    const bool is_last = &tick == &scale.ticks.back();  // words: they go on to the right
    legend.labels.push_back(
        {kBarX + scale.position(tick.value) * width, kBaseline, kTextSize, tick.label, !is_last});
  }
  return legend;
}

}  // namespace unwrapd::figure
