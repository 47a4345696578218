#include "core/figure/layout_image.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/figure/island_numbers.hpp"
#include "core/figure/legend.hpp"
#include "core/figure/lettering.hpp"
#include "core/figure/painting.hpp"
#include "core/figure/raster.hpp"

namespace unwrapd::figure {
namespace {

constexpr double kOutlineWidth = 3, kFlipWidth = 12;  // in 1/4096 of the page's side
constexpr double kHatchPeriod = 36;                   // the same, between two stripes
constexpr double kMinPeriod = 6;                      // pixels
constexpr double kWireWidth = 1.5;                    // the same
constexpr double kMinLine = 0.7, kMinFlip = 3;        // pixels
constexpr double kMinNumber = 6;                      // pixels, height of a font
constexpr double kHalo = 3;                           // width of the pen, see Pen

using Drawing = std::vector<FlatTriangle>;

/// From UVs and from units of the page to pixels.
struct Scale {
  Frame frame;
  double size;   ///< of the square that the frame is, pixels
  double above;  ///< how much of it is cut off above the picture, pixels

  [[nodiscard]] Vec2 pixel(const Vec2& uv) const {
    const Vec2 place = frame.place(uv);
    return {size * place.x(), size * (1 - place.y()) - above};
  }
  [[nodiscard]] double length(double units) const { return units * size / kPageUnits; }
  [[nodiscard]] double line(double units) const { return std::max(kMinLine, length(units)); }
};

/// Where the page and the legend below it lie, pixels.
struct Extent {
  int width;
  int page_height;
  int height;
};

Extent extent_of(const LayoutLook& look, int size) {
  const Vec2 sides = look.is_cropped ? look.page : Vec2::Ones();
  const auto pixels = [](double length) {
    return std::max(1, static_cast<int>(std::lround(length)));
  };
  Extent extent{
      .width = pixels(size * sides.x()), .page_height = pixels(size * sides.y()), .height = 0};
  const double legend =
      look.legend ? kLegendUnits * static_cast<double>(extent.width) / kPageUnits : 0;
  extent.height = extent.page_height + static_cast<int>(std::lround(legend));
  return extent;
}

ScreenTriangle on_screen(const Triangle& face, const UvMap& uv, const Scale& scale) {
  return {snapped(scale.pixel(uv[face[0]])), snapped(scale.pixel(uv[face[1]])),
          snapped(scale.pixel(uv[face[2]]))};
}

/// A flipped triangle; with `width` > 0 so broad that it shows however small it is.
void append_flipped(Drawing& drawing, const Triangle& face, const UvMap& uv, const Scale& scale,
                    double width) {
  drawing.push_back({on_screen(face, uv, scale), kFlippedColour});
  for (std::size_t k = 0; width > 0 && k < 3; ++k)
    append_line(drawing, {scale.pixel(uv[face[k]]), scale.pixel(uv[face[(k + 1) % 3]])}, width,
                kFlippedColour);
}

void append_faces(Drawing& drawing, const UnwrappedSurface& surface,
                  std::span<const std::uint8_t> painted, std::span<const Rgb> colours,
                  const Scale& scale) {
  for (std::size_t t = 0; t < painted.size(); ++t) {
    if (painted[t] < colours.size())
      drawing.push_back({on_screen(surface.faces[t], surface.uv, scale), colours[painted[t]]});
  }
}

/// Stripes across every place that two triangles share.
void append_hatching(Drawing& drawing, std::span<const Polygon> overlaps, const Scale& scale) {
  const double period = std::max(kMinPeriod, scale.length(kHatchPeriod)), width = period / 3;
  const Vec2 across = Vec2(1, 1).normalized();
  for (const Polygon& overlap : overlaps) {
    Polygon place;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec2& uv : overlap) {
      place.push_back(scale.pixel(uv));
      low = std::min(low, across.dot(place.back()));
      high = std::max(high, across.dot(place.back()));
    }
    for (double at = period * std::floor(low / period); at < high; at += period) {
      const Polygon stripe = clipped(place, across, at, at + width);
      for (std::size_t k = 2; k < stripe.size(); ++k)
        drawing.push_back(
            {{snapped(stripe[0]), snapped(stripe[k - 1]), snapped(stripe[k])}, kOverlapColour});
    }
  }
}

void append_edges(Drawing& drawing, std::span<const Edge> edges, const UvMap& uv,
                  const Scale& scale) {
  for (const Edge& edge : edges)
    append_line(drawing, {scale.pixel(uv[edge[0]]), scale.pixel(uv[edge[1]])},
                scale.line(kOutlineWidth), kInk);
}

/// What of the square is not the page.
void append_margins(Drawing& drawing, const Vec2& page, const Scale& scale) {
  const double right = scale.size * page.x(), top = scale.size * (1 - page.y());
  if (page.x() < 1) append_rectangle(drawing, {right, 0}, {scale.size, scale.size}, kPaper);
  if (page.y() < 1) append_rectangle(drawing, {0, 0}, {scale.size, top}, kPaper);
}

/// The edges between triangles.
void append_wires(Drawing& drawing, const UnwrappedSurface& surface, const Scale& scale) {
  for (const Edge& edge : inner_edges(surface))
    append_thin_line(drawing, {scale.pixel(surface.uv[edge[0]]), scale.pixel(surface.uv[edge[1]])},
                     scale.line(kWireWidth), kWire);
}

/// The numbers of islands that are large enough for them, on a brighter ground where colours are.
void append_numbers(Drawing& drawing, std::span<const UnwrappedSurface> unwrapped,
                    const LayoutLook& look, const Scale& scale) {
  const std::vector<IslandMark> marks = island_marks(unwrapped);
  for (std::size_t k = 0; k < marks.size(); ++k) {
    const double size = scale.size / scale.frame.side * marks[k].size;
    if (size < kMinNumber) continue;
    const std::string text = std::to_string(k + 1);
    const Vec2 offset(-text_width(text, size) / 2, kDigitHeight * size / 2);
    const Vec2 start = scale.pixel(marks[k].middle) + offset;
    if (!look.wireframe)
      append_text(drawing, text, start, size, {.colour = kPaper, .width = kHalo});
    append_text(drawing, text, start, size);
  }
}

void append_legend(Drawing& drawing, const ColourScale& colours, const Extent& extent) {
  const auto length = [&](double units) { return units * extent.width / kPageUnits; };
  const auto place = [&](double x, double y) {
    return Vec2(length(x), extent.page_height + length(y - kPageUnits));
  };
  append_rectangle(drawing, place(0, kPageUnits), {extent.width, extent.height}, kPaper);
  const Legend legend = legend_of(colours);
  for (const Swatch& s : legend.swatches)
    append_rectangle(drawing, place(s.x, s.y), place(s.x + s.width, s.y + s.height), s.colour);
  for (const Label& label : legend.labels) {
    const double size = length(label.size);
    const double left = label.is_centred ? text_width(label.text, size) / 2 : 0;
    append_text(drawing, label.text, place(label.x, label.y) - Vec2(left, 0), size);
  }
}

/// Triangles in their colours, flipped ones above them, and what is hatched.
void append_colours(Drawing& drawing, std::span<const Surface> surfaces,
                    std::span<const UnwrappedSurface> unwrapped, const LayoutLook& look,
                    const Scale& scale, const std::stop_token& stop) {
  const ColourScale& colours = colour_scale(look.colouring);
  const auto painted = painted_faces(surfaces, unwrapped, look.colouring);
  throw_if_cancelled(stop);
  for (std::size_t s = 0; s < unwrapped.size(); ++s)
    append_faces(drawing, unwrapped[s], painted[s], colours.colours, scale);
  const double flip_width =
      look.colouring == Colouring::flips ? std::max(kMinFlip, scale.length(kFlipWidth)) : 0;
  for (std::size_t s = 0; s < unwrapped.size(); ++s)
    for (std::size_t t = 0; t < painted[s].size(); ++t)
      if (painted[s][t] == kFlippedFace)
        append_flipped(drawing, unwrapped[s].faces[t], unwrapped[s].uv, scale, flip_width);
  append_hatching(drawing, overlap_polygons(unwrapped, stop), scale);
}

}  // namespace

Image layout_image(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
                   const LayoutLook& look, int size, const std::stop_token& stop) {
  assert(size >= 1 && size <= kMaxImageSize);
  const Extent extent = extent_of(look, size);
  const PageBorders pages = page_borders(look);
  const Scale scale{.frame = look.is_cropped ? Frame() : frame_of(unwrapped, pages),
                    .size = static_cast<double>(size),
                    .above = look.is_cropped ? size * (1 - look.page.y()) : 0};
  Drawing drawing;
  if (look.background && !look.is_cropped && scale.frame.side == 1)
    append_margins(drawing, look.page, scale);
  if (look.wireframe) {
    for (const UnwrappedSurface& surface : unwrapped) append_wires(drawing, surface, scale);
  } else {
    append_colours(drawing, surfaces, unwrapped, look, scale, stop);
  }
  throw_if_cancelled(stop);
  for (const UnwrappedSurface& surface : unwrapped)
    append_edges(drawing, outline(surface), surface.uv, scale);
  append_edges(drawing, pages.edges, pages.uv, scale);
  if (look.numbers) append_numbers(drawing, unwrapped, look, scale);
  if (look.legend) append_legend(drawing, colour_scale(look.colouring), extent);
  const std::optional<Rgb> background = look.background ? std::optional(kPage) : std::nullopt;
  return rasterised(drawing, {extent.width, extent.height, background}, stop);
}

}  // namespace unwrapd::figure
