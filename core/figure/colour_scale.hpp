#pragma once
// What the colours of a layout say: which figure of a triangle is shown, and on what scale.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/figure/image.hpp"
#include "core/measure/jacobian.hpp"

namespace unwrapd::figure {

enum class Colouring { stretch, angle, area, flips };

/// In the order of the enumerators.
inline constexpr std::array<std::string_view, 4> kColouringNames = {"stretch", "angle", "area",
                                                                    "flips"};

std::optional<Colouring> colouring_named(std::string_view name);

/// How a layout is drawn.
struct LayoutLook {
  LayoutLook(Colouring shown = Colouring::stretch, const Vec2& extent = Vec2::Ones())
      : colouring(shown), page(extent) {}

  Colouring colouring;
  Vec2 page;                 ///< its sides, the longer one 1; UVs are in these units
  bool legend = true;        ///< below the page
  bool background = true;    ///< false: transparent wherever nothing is drawn
  bool wireframe = false;    ///< the edges of all triangles, in place of their colours
  bool numbers = false;      ///< of islands (island_numbers.hpp)
  bool is_cropped = false;   ///< to the page: what lies beyond it is cut off, as are margins
  int page_count = 1;        ///< UDIM tiles with islands, each with a border if there are several
  Vec2 tile = Vec2::Ones();  ///< sides of each of them
};

/// A figure that stands below the bar.
struct Tick {
  double value = 0;
  std::string_view label;
};

/// Colours of equal width on a logarithmic scale of ratios. The last one is of all values from
/// `high` on; where `two_sided`, the first one is of all below `low`.
struct ColourScale {
  std::string_view title;
  std::string_view caption;  ///< what is shown; ratios, without unit
  std::span<const Rgb> colours;
  double low = 1;
  double high = 4;
  bool two_sided = false;
  std::span<const Tick> ticks;

  /// Where a value lies on the bar, in colours from its left end; NaN counts as the worst.
  [[nodiscard]] double position(double value) const;
  /// The number of its colour.
  [[nodiscard]] std::uint8_t colour_of(double value) const;
};

const ColourScale& colour_scale(Colouring colouring);

inline constexpr Rgb kFlippedColour = {0xff, 0x2a, 0x4d};
inline constexpr Rgb kOverlapColour = {0x52, 0x00, 0x7a};  ///< of the hatching
inline constexpr Rgb kWire = {0x8a, 0x85, 0x96};           ///< edges within an island
inline constexpr Rgb kInk = {0x16, 0x13, 0x1f};
inline constexpr Rgb kPaper = {0xff, 0xff, 0xff};
inline constexpr Rgb kPage = {0xe9, 0xe8, 0xed};

/// The figure of a triangle that is not flipped, `scale` being the factor for UVs that makes UV
/// area = 3D area: sigma_max / sigma_min (angle), the determinant (area), max(sigma_max,
/// 1 / sigma_min) (stretch), 1 (flips). Infinite or NaN where the image has no area.
double shown_value(Colouring colouring, const measure::Jacobian& j, double scale);

}  // namespace unwrapd::figure
