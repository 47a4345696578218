// Colours at even steps of lightness in OKLCH (Ottosson 2020), so that they stay in order in grey
// too. Deviations from 1 are worse the further they go: one direction. Areas can err in two, blue
// where the page has too little and brown where it has too much; what is right is almost white.
// A rainbow, as in many papers, has edges where the figures have none.
#include "core/figure/colour_scale.hpp"

#include <algorithm>
#include <cmath>

namespace unwrapd::figure {
namespace {

constexpr std::array<Rgb, 12> kWorse = {{{0xd1, 0xfd, 0xc7},
                                         {0xa5, 0xf0, 0xbc},
                                         {0x74, 0xe2, 0xba},
                                         {0x35, 0xd2, 0xbc},
                                         {0x00, 0xc0, 0xc0},
                                         {0x00, 0xab, 0xc1},
                                         {0x00, 0x94, 0xbe},
                                         {0x00, 0x7d, 0xb5},
                                         {0x1d, 0x66, 0xa5},
                                         {0x32, 0x51, 0x8e},
                                         {0x38, 0x3e, 0x74},
                                         {0x35, 0x2e, 0x57}}};
constexpr std::array<Rgb, 13> kLessOrMore = {{{0x14, 0x3b, 0x7b},
                                              {0x22, 0x59, 0x9d},
                                              {0x3a, 0x79, 0xba},
                                              {0x5b, 0x99, 0xd2},
                                              {0x84, 0xb9, 0xe4},
                                              {0xb3, 0xd8, 0xf3},
                                              {0xf4, 0xf4, 0xef},
                                              {0xe6, 0xd1, 0xab},
                                              {0xd5, 0xad, 0x75},
                                              {0xc3, 0x89, 0x44},
                                              {0xad, 0x66, 0x13},
                                              {0x93, 0x46, 0x00},
                                              {0x74, 0x29, 0x00}}};
constexpr std::array<Rgb, 1> kOneGrey = {{{0xc9, 0xc7, 0xd0}}};

constexpr std::array<Tick, 3> kOneSided = {{{1, "1"}, {2, "2"}, {4, "4 or more"}}};
constexpr std::array<Tick, 5> kTwoSided = {
    {{0.25, "1/4"}, {0.5, "1/2"}, {1, "1"}, {2, "2"}, {4, "4 or more"}}};
constexpr std::array<Tick, 1> kInOrder = {{{1, "in order"}}};

constexpr std::array<ColourScale, kColouringNames.size()> kScales = {
    ColourScale{"stretch", "longer or shorter than in space", kWorse, 1, 4, false, kOneSided},
    ColourScale{"angle", "longest / shortest stretch", kWorse, 1, 4, false, kOneSided},
    ColourScale{"area", "on the page / in space", kLessOrMore, 0.25, 4, true, kTwoSided},
    ColourScale{"flips", "which way round", kOneGrey, 1, 4, false, kInOrder}};

}  // namespace

std::optional<Colouring> colouring_named(std::string_view name) {
  const auto found = std::ranges::find(kColouringNames, name);
  if (found == kColouringNames.end()) return std::nullopt;
  return static_cast<Colouring>(found - kColouringNames.begin());
}

double ColourScale::position(double value) const {
  const double last = static_cast<double>(colours.size()) - 1, first = two_sided ? 1 : 0;
  const double place = first + (last - first) * std::log(value / low) / std::log(high / low);
  return place <= last ? std::max(place, 0.0) : last;  // NaN is last
}

std::uint8_t ColourScale::colour_of(double value) const {
  return static_cast<std::uint8_t>(position(value));
}

const ColourScale& colour_scale(Colouring colouring) {
  return kScales[static_cast<std::size_t>(colouring)];
}

double shown_value(Colouring colouring, const measure::Jacobian& j, double scale) {
  switch (colouring) {
    case Colouring::stretch:
      return std::max(scale * j.sigma_max(), 1 / (scale * std::abs(j.sigma_min())));
    case Colouring::angle:
      return j.sigma_max() / std::abs(j.sigma_min());
    case Colouring::area:
      return scale * scale * std::abs(j.determinant());
    case Colouring::flips:
      return 1;
  }
  return 1;
}

}  // namespace unwrapd::figure
