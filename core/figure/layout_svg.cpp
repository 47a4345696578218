// The layout as text: triangles go into one path for each colour, so the document has about twenty
// elements however large the mesh. Coordinates are whole tenths of 1/4096 of the page, written with
// std::to_chars relative to a triangle's first corner, which keeps them short.
#include "core/figure/layout_svg.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/figure/island_numbers.hpp"
#include "core/figure/legend.hpp"
#include "core/figure/lettering.hpp"
#include "core/figure/painting.hpp"

namespace unwrapd::figure {
namespace {

constexpr double kUnits = 40960;    // coordinates a page's side
constexpr double kMinFont = 8;      // units, height of a font
constexpr double kMaxUnits = 1e12;  // no UV, however far off, leaves the range of long

/// The data of the paths: one for each colour, flipped triangles, edges between triangles,
/// boundaries.
struct Paths {
  std::vector<std::string> colour;
  std::string flipped;
  std::string wires;
  std::string boundary;
};

void append(std::string& text, long number) {
  std::array<char, 24> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  text.append(digits.data(), end);
}

void append_point(std::string& text, char command, long x, long y) {
  text += command;
  append(text, x);
  if (y >= 0) text += ' ';  // a minus sign parts the numbers as well
  append(text, y);
}

using Point = std::array<long, 2>;

/// The place of a UV in the picture.
class Places {
 public:
  Places(const UvMap& uv, const Frame& frame) : uv_(uv), frame_(frame) {}

  [[nodiscard]] Point at(Index vertex) const {
    const Vec2 place =
        (kUnits * frame_.place(uv_[vertex])).cwiseMax(-kMaxUnits).cwiseMin(kMaxUnits);
    return {std::lround(place.x()), std::lround(place.y())};
  }

 private:
  const UvMap& uv_;
  const Frame& frame_;
};

void append_line(std::string& text, const Point& from, const Point& to) {
  append_point(text, 'l', to[0] - from[0], to[1] - from[1]);
}

void append_triangle(std::string& text, const Triangle& face, const Places& places) {
  const Point a = places.at(face[0]), b = places.at(face[1]), c = places.at(face[2]);
  append_point(text, 'M', a[0], a[1]);
  append_line(text, a, b);
  append_line(text, b, c);
  text += 'z';
}

void append_edge(std::string& text, const Edge& edge, const Places& places) {
  const Point a = places.at(edge[0]), b = places.at(edge[1]);
  append_point(text, 'M', a[0], a[1]);
  append_line(text, a, b);
}

void draw(const UnwrappedSurface& surface, std::span<const std::uint8_t> painted,
          const Frame& frame, const std::stop_token& stop, Paths& paths) {
  const Places places(surface.uv, frame);
  for (std::size_t t = 0; t < painted.size(); ++t) {
    check_cancelled_every(t, stop);
    if (painted[t] == kHiddenFace) continue;
    std::string& path = painted[t] == kFlippedFace ? paths.flipped : paths.colour[painted[t]];
    append_triangle(path, surface.faces[t], places);
  }
  for (const Edge& edge : outline(surface)) append_edge(paths.boundary, edge, places);
}

void draw_wires(const UnwrappedSurface& surface, const Frame& frame, Paths& paths) {
  const Places places(surface.uv, frame);
  for (const Edge& edge : inner_edges(surface)) append_edge(paths.wires, edge, places);
  for (const Edge& edge : outline(surface)) append_edge(paths.boundary, edge, places);
}

/// Triangles of one colour. A stroke of that colour hides the hairlines between neighbours.
void append_fill(std::string& svg, const Rgb& colour, std::string_view data, long stroke) {
  if (data.empty()) return;
  svg.append("<path fill=\"").append(hex(colour)).append("\" stroke=\"").append(hex(colour));
  svg.append("\" stroke-width=\"");
  append(svg, stroke);
  svg.append("\" d=\"").append(data).append("\"/>\n");
}

/// Pattern units are those of the drawing, whose V points up.
void append_hatching(std::string& svg, const std::vector<Polygon>& overlaps, const Frame& frame) {
  if (overlaps.empty()) return;
  svg.append(
      "<defs><pattern id=\"shared\" width=\"360\" height=\"360\" patternUnits=\"userSpaceOnUse\" "
      "patternTransform=\"rotate(45)\"><rect width=\"120\" height=\"360\" fill=\"");
  svg.append(hex(kOverlapColour)).append("\"/></pattern></defs>\n<path fill=\"url(#shared)\" d=\"");
  for (const Polygon& polygon : overlaps) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec2 place = kUnits * frame.place(polygon[k]);
      append_point(svg, k == 0 ? 'M' : 'L', std::lround(place.x()), std::lround(place.y()));
    }
    svg += 'z';
  }
  svg.append("\"><title>shared by two triangles</title></path>\n");
}

void append_strokes(std::string& svg, const Rgb& colour, long width, std::string_view data) {
  svg.append("<path fill=\"none\" stroke=\"").append(hex(colour)).append("\" stroke-width=\"");
  append(svg, width);
  svg.append("\" d=\"").append(data).append("\"/>\n");
}

void append_attribute(std::string& svg, std::string_view name, double value) {
  svg.append(" ").append(name).append("=\"");
  append(svg, std::lround(value));
  svg += '"';
}

void append_swatch(std::string& svg, const Swatch& swatch) {
  const long left = std::lround(swatch.x), right = std::lround(swatch.x + swatch.width);
  svg += "<rect";
  append_attribute(svg, "x", swatch.x);
  append_attribute(svg, "y", swatch.y);
  append_attribute(svg, "width", static_cast<double>(right - left));
  append_attribute(svg, "height", swatch.height);
  svg.append(" fill=\"").append(hex(swatch.colour)).append("\"/>\n");
}

void append_label(std::string& svg, const Label& label) {
  svg += "<text";
  append_attribute(svg, "x", label.x);
  append_attribute(svg, "y", label.y);
  append_attribute(svg, "font-size", label.size);
  if (label.is_centred) svg += " text-anchor=\"middle\"";
  svg.append(">").append(label.text).append("</text>\n");
}

/// The part of the drawing that is shown, in whole units; the legend is as wide.
struct Shown {
  long width;
  long top;     ///< of the page
  long legend;  ///< its height, 0 for none

  [[nodiscard]] long height() const { return kPageUnits - top + legend; }
};

Shown shown_of(const LayoutLook& look) {
  const Vec2 sides = look.is_cropped ? look.page : Vec2::Ones();
  const long width = std::max(1L, std::lround(kPageUnits * sides.x()));
  return {.width = width,
          .top = kPageUnits - std::max(1L, std::lround(kPageUnits * sides.y())),
          .legend = look.legend ? std::lround(double{kLegendUnits} * static_cast<double>(width) /
                                              kPageUnits)
                                : 0};
}

/// A legend that is narrower than the page's square is scaled about the page's lower left corner.
void append_legend(std::string& svg, const ColourScale& scale, const Shown& shown) {
  const Legend legend = legend_of(scale);
  svg.append("<g font-family=\"sans-serif\" fill=\"").append(hex(kInk)).append("\"");
  if (shown.width < kPageUnits) {
    svg += " transform=\"translate(0 4096) scale(";
    append(svg, shown.width);
    svg += ") scale(.000244140625) translate(0 -4096)\"";  // 1/4096
  }
  svg += ">\n";
  for (const Swatch& swatch : legend.swatches) append_swatch(svg, swatch);
  for (const Label& label : legend.labels) append_label(svg, label);
  svg += "</g>\n";
}

/// On a brighter ground where colours are.
void append_numbers(std::string& svg, std::span<const UnwrappedSurface> unwrapped,
                    const LayoutLook& look, const Frame& frame) {
  svg.append("<g font-family=\"sans-serif\" text-anchor=\"middle\" fill=\"").append(hex(kInk));
  if (!look.wireframe) svg.append("\" paint-order=\"stroke\" stroke=\"").append(hex(kPaper));
  svg += "\">\n";
  long number = 0;
  for (const IslandMark& mark : island_marks(unwrapped)) {
    ++number;
    const double size = kPageUnits / frame.side * mark.size;
    if (size < kMinFont) continue;
    const Vec2 place = kPageUnits * frame.place(mark.middle);
    svg += "<text";
    append_attribute(svg, "x", place.x());
    append_attribute(svg, "y", kPageUnits - place.y() + kDigitHeight * size / 2);
    append_attribute(svg, "font-size", size);
    if (!look.wireframe) append_attribute(svg, "stroke-width", size / 5);
    svg += '>';
    append(svg, number);
    svg += "</text>\n";
  }
  svg += "</g>\n";
}

void append_page(std::string& svg, const Vec2& page) {
  const long width = std::lround(kPageUnits * page.x()),
             height = std::lround(kPageUnits * page.y());
  svg += "<rect";
  if (height < kPageUnits) append_attribute(svg, "y", static_cast<double>(kPageUnits - height));
  append_attribute(svg, "width", static_cast<double>(width));
  append_attribute(svg, "height", static_cast<double>(height));
  svg.append(" fill=\"").append(hex(kPage)).append("\"/>\n");
}

void append_head(std::string& svg, const LayoutLook& look, const Shown& shown) {
  svg += "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 ";
  for (const long number : {shown.top, shown.width}) {
    append(svg, number);
    svg += ' ';
  }
  append(svg, shown.height());
  svg += "\">\n<title>UV layout";
  if (!look.wireframe) svg.append(", coloured by ").append(colour_scale(look.colouring).title);
  svg += "</title>\n";
}

void append_background(std::string& svg, const Vec2& page, const Shown& shown) {
  svg += "<rect";
  if (shown.top > 0) append_attribute(svg, "y", static_cast<double>(shown.top));
  append_attribute(svg, "width", static_cast<double>(shown.width));
  append_attribute(svg, "height", static_cast<double>(shown.height()));
  svg.append(" fill=\"").append(hex(kPaper)).append("\"/>\n");
  append_page(svg, page);
}

/// Triangles in their colours, flipped ones above them.
void append_colours(std::string& svg, const Paths& paths, const LayoutLook& look) {
  const ColourScale& scale = colour_scale(look.colouring);
  for (std::size_t k = 0; k < scale.colours.size(); ++k)
    append_fill(svg, scale.colours[k], paths.colour[k], 5);
  append_fill(svg, kFlippedColour, paths.flipped, look.colouring == Colouring::flips ? 120 : 5);
}

Paths paths_of(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
               const LayoutLook& look, const Frame& frame, const std::stop_token& stop) {
  Paths paths;
  paths.colour.resize(colour_scale(look.colouring).colours.size());
  if (look.wireframe) {
    for (const UnwrappedSurface& surface : unwrapped) draw_wires(surface, frame, paths);
    return paths;
  }
  const auto painted = painted_faces(surfaces, unwrapped, look.colouring);
  for (std::size_t s = 0; s < unwrapped.size(); ++s)
    draw(unwrapped[s], painted[s], frame, stop, paths);
  return paths;
}

}  // namespace

std::string layout_svg(std::span<const Surface> surfaces,
                       std::span<const UnwrappedSurface> unwrapped, const LayoutLook& look,
                       const std::stop_token& stop) {
  const PageBorders pages = page_borders(look);
  const Frame frame = look.is_cropped ? Frame() : frame_of(unwrapped, pages);
  const Shown shown = shown_of(look);
  Paths paths = paths_of(surfaces, unwrapped, look, frame, stop);
  for (const Edge& edge : pages.edges) append_edge(paths.boundary, edge, {pages.uv, frame});
  std::string svg;
  append_head(svg, look, shown);
  if (look.background)
    append_background(svg, frame.side == 1 ? look.page : Vec2(Vec2::Ones()), shown);
  svg += "<g transform=\"matrix(.1 0 0 -.1 0 4096)\" stroke-linejoin=\"round\">\n";
  append_colours(svg, paths, look);
  if (look.wireframe) {
    append_strokes(svg, kWire, 15, paths.wires);
  } else {
    append_hatching(svg, overlap_polygons(unwrapped, stop), frame);
  }
  append_strokes(svg, kInk, 30, paths.boundary);
  svg += "</g>\n";
  if (look.numbers) append_numbers(svg, unwrapped, look, frame);
  if (look.legend) append_legend(svg, colour_scale(look.colouring), shown);
  svg += "</svg>\n";
  return svg;
}

}  // namespace unwrapd::figure
