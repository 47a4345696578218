// The layout as text: triangles go into one path for each colour, so the document has about twenty
// elements however large the mesh. Coordinates are whole tenths of 1/4096 of the page, written with
// std::to_chars relative to a triangle's first corner, which keeps them short.
#include "core/figure/layout_svg.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/figure/legend.hpp"
#include "core/figure/painting.hpp"

namespace unwrapd::figure {
namespace {

constexpr double kUnits = 40960;    // coordinates a page's side
constexpr double kMaxUnits = 1e12;  // no UV, however far off, leaves the range of long

/// The data of the paths: one for each colour, flipped triangles, boundaries.
struct Paths {
  std::vector<std::string> colour;
  std::string flipped;
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

void append_boundary(std::string& svg, std::string_view data) {
  svg.append("<path fill=\"none\" stroke=\"").append(hex(kInk));
  svg.append("\" stroke-width=\"30\" d=\"").append(data).append("\"/>\n");
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

void append_legend(std::string& svg, const ColourScale& scale) {
  const Legend legend = legend_of(scale);
  svg.append("<g font-family=\"sans-serif\" fill=\"").append(hex(kInk)).append("\">\n");
  for (const Swatch& swatch : legend.swatches) append_swatch(svg, swatch);
  for (const Label& label : legend.labels) append_label(svg, label);
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

void append_head(std::string& svg, const ColourScale& scale, const Vec2& page) {
  svg +=
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 4096 4416\">\n"
      "<title>UV layout, coloured by ";
  svg.append(scale.title).append("</title>\n");
  svg.append("<rect width=\"4096\" height=\"4416\" fill=\"").append(hex(kPaper)).append("\"/>\n");
  append_page(svg, page);
}

static_assert(kPageUnits == 4096 && kLegendUnits == 320, "append_head() spells them out");

}  // namespace

std::string layout_svg(std::span<const Surface> surfaces,
                       std::span<const UnwrappedSurface> unwrapped, const LayoutLook& look,
                       const std::stop_token& stop) {
  const ColourScale& scale = colour_scale(look.colouring);
  const auto painted = painted_faces(surfaces, unwrapped, look.colouring);
  const Frame frame = frame_of(unwrapped);
  Paths paths{
      .colour = std::vector<std::string>(scale.colours.size()), .flipped = {}, .boundary = {}};
  for (std::size_t s = 0; s < unwrapped.size(); ++s)
    draw(unwrapped[s], painted[s], frame, stop, paths);
  std::string svg;
  append_head(svg, scale, frame.side == 1 ? look.page : Vec2::Ones());
  svg += "<g transform=\"matrix(.1 0 0 -.1 0 4096)\" stroke-linejoin=\"round\">\n";
  for (std::size_t k = 0; k < scale.colours.size(); ++k)
    append_fill(svg, scale.colours[k], paths.colour[k], 5);
  append_fill(svg, kFlippedColour, paths.flipped, look.colouring == Colouring::flips ? 120 : 5);
  append_hatching(svg, overlap_polygons(unwrapped, stop), frame);
  append_boundary(svg, paths.boundary);
  svg += "</g>\n";
  append_legend(svg, scale);
  svg += "</svg>\n";
  return svg;
}

}  // namespace unwrapd::figure
