#include "core/asset/base/colour.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace unwrapd::asset {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr Colour kUnknown = {kNone, kNone, kNone, kNone};
constexpr std::size_t kAlpha = 3;
constexpr float kLargestShare = 2;  // some files have shares a little above 1

std::array<bool, 4> channels_of_bytes(const std::vector<Colour>& colours,
                                      const UnitUnknown& unit_unknown) {
  std::array<bool, 4> of_bytes{};
  for (const Colour& colour : colours)
    for (std::size_t k = 0; k < colour.size(); ++k)
      of_bytes[k] |= unit_unknown[k] && std::isfinite(colour[k]) && colour[k] > kLargestShare;
  return of_bytes;
}

}  // namespace

std::optional<Colour> colour_in(Words words) {
  Colour colour = kUnknown;
  for (std::size_t k = 0; k < colour.size(); ++k) {
    const std::optional<double> value = number_in(words.next());
    if (!value && k < kAlpha) return std::nullopt;
    if (value) colour[k] = static_cast<float>(*value);
  }
  return colour;
}

void add_colour(const std::optional<Colour>& colour, std::size_t vertex_count,
                std::vector<Colour>& colours) {
  if (!colour && colours.empty()) return;
  colours.resize(vertex_count - 1, kUnknown);
  colours.push_back(colour.value_or(kUnknown));
}

void normalize_colours(std::vector<Colour>& colours, const UnitUnknown& unit_unknown) {
  const std::array<bool, 4> of_bytes = channels_of_bytes(colours, unit_unknown);
  const bool is_any = std::ranges::any_of(of_bytes, [](bool own) { return own; });
  Colour unit{};
  for (std::size_t k = 0; k < unit.size(); ++k)
    unit[k] = unit_unknown[k] && (k < kAlpha ? is_any : of_bytes[kAlpha]) ? 255 : 1;
  for (Colour& colour : colours)
    for (std::size_t k = 0; k < unit.size(); ++k)
      colour[k] = std::clamp(colour[k] / unit[k], 0.0F, 1.0F);  // NaN stays
}

Colour as_shown(const Colour& colour) {
  Colour shown = colour;
  for (float& value : shown)
    if (std::isnan(value)) value = 1;
  return shown;
}

}  // namespace unwrapd::asset
