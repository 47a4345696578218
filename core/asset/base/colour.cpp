#include "core/asset/base/colour.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace unwrapd::asset {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr Colour kUnknown = {kNone, kNone, kNone, kNone};

bool is_in_bytes(const Colour& colour) {
  return std::ranges::any_of(std::span(colour).first(3), [](float value) { return value > 1; });
}

}  // namespace

std::optional<Colour> colour_in(Words words) {
  Colour colour = kUnknown;
  for (std::size_t k = 0; k < colour.size(); ++k) {
    const std::optional<double> value = number_in(words.next());
    if (!value && k < 3) return std::nullopt;
    if (value) colour[k] = static_cast<float>(*value);
  }
  return colour;
}

void add_colour(const std::optional<Colour>& colour, std::size_t vertices,
                std::vector<Colour>& colours) {
  if (!colour && colours.empty()) return;
  colours.resize(vertices - 1, kUnknown);
  colours.push_back(colour.value_or(kUnknown));
}

void to_shares(std::vector<Colour>& colours) {
  const float unit = std::ranges::any_of(colours, is_in_bytes) ? 255 : 1;
  for (Colour& colour : colours)
    for (float& value : colour)
      value = std::isnan(value) ? 1 : std::clamp(value / unit, 0.0F, 1.0F);
}

}  // namespace unwrapd::asset
