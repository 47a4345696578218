// An alphabet of strokes: straight lines and arcs of ellipses, as on an architect's drawing. It is
// drawn by the same scan converter as all else, sharp at every size; a bitmap font is so at one
// size only, and a font file would be one more dependency.
#include "core/figure/lettering.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "core/figure/colour_scale.hpp"

namespace unwrapd::figure {
namespace {

/// An arc about (x, y) with radii (rx, ry) between two angles, degrees, anticlockwise from the
/// right; or, where from == to == kLine, the line from (x, y) to (rx, ry). The baseline is y = 0,
/// small letters reach 5 and tall ones 7.6.
struct Stroke {
  double x, y, rx, ry, from, to;
};

constexpr double kLine = 1000;
constexpr double kFontUnits = 10.5;  // of a font's height
constexpr double kGap = 1.7;         // between letters
constexpr double kSpace = 2.2;       // width of a blank
constexpr double kMaxPiece = 15;     // degrees of an arc that a straight piece stands for

constexpr Stroke line(double x0, double y0, double x1, double y1) {
  return {x0, y0, x1, y1, kLine, kLine};
}
constexpr Stroke kBowl = Stroke{2, 2.5, 2, 2.5, 0, 360};

struct Glyph {
  char letter;
  double width;
  std::array<Stroke, 4> strokes;
  std::size_t count;
};

template <class... Strokes>
constexpr Glyph glyph(char letter, double width, Strokes... strokes) {
  return {letter, width, {strokes...}, sizeof...(strokes)};
}

constexpr std::array kGlyphs{
    glyph('a', 4, kBowl, line(4, 5, 4, 0)),
    glyph('b', 4, kBowl, line(0, 7.6, 0, 0)),
    glyph('c', 3.6, Stroke{2, 2.5, 2, 2.5, 50, 310}),
    glyph('d', 4, kBowl, line(4, 7.6, 4, 0)),
    glyph('e', 4, Stroke{2, 2.5, 2, 2.5, 0, 315}, line(0, 2.5, 4, 2.5)),
    glyph('f', 2.8, Stroke{2.6, 6, 1.4, 1.6, 70, 180}, line(1.2, 6, 1.2, 0), line(0, 5, 2.8, 5)),
    glyph('g', 4, kBowl, line(4, 5, 4, -0.4), Stroke{2, -0.4, 2, 2, 210, 360}),
    glyph('h', 4, line(0, 7.6, 0, 0), Stroke{2, 3, 2, 2, 0, 180}, line(4, 3, 4, 0)),
    glyph('i', 0.4, line(0.2, 5, 0.2, 0), line(0.2, 7.1, 0.2, 7.2)),
    glyph('j', 1.4, line(1.2, 5, 1.2, -1), Stroke{0, -1, 1.2, 1.4, 270, 360},
          line(1.2, 7.1, 1.2, 7.2)),
    glyph('k', 3.6, line(0, 7.6, 0, 0), line(3.3, 5, 0, 2), line(1.3, 3.2, 3.6, 0)),
    glyph('l', 0.4, line(0.2, 7.6, 0.2, 0)),
    glyph('m', 6, line(0, 5, 0, 0), Stroke{1.5, 3.4, 1.5, 1.6, 0, 180}, line(3, 3.4, 3, 0),
          Stroke{4.5, 3.4, 1.5, 1.6, 0, 180}),
    glyph('n', 4, line(0, 5, 0, 0), Stroke{2, 3, 2, 2, 0, 180}, line(4, 3, 4, 0)),
    glyph('o', 4, kBowl),
    glyph('p', 4, kBowl, line(0, 5, 0, -2.4)),
    glyph('q', 4, kBowl, line(4, 5, 4, -2.4)),
    glyph('r', 2.4, line(0, 5, 0, 0), Stroke{2, 2.9, 2, 2.1, 70, 180}),
    glyph('s', 3.4, Stroke{1.7, 3.75, 1.6, 1.25, 35, 270}, Stroke{1.7, 1.25, 1.7, 1.25, -145, 90}),
    glyph('t', 2.8, line(1.2, 6.8, 1.2, 1.4), Stroke{2.6, 1.4, 1.4, 1.4, 180, 285},
          line(0, 5, 2.8, 5)),
    glyph('u', 4, line(0, 5, 0, 2), Stroke{2, 2, 2, 2, 180, 360}, line(4, 5, 4, 0)),
    glyph('v', 3.8, line(0, 5, 1.9, 0), line(1.9, 0, 3.8, 5)),
    glyph('w', 5.6, line(0, 5, 1.4, 0), line(1.4, 0, 2.8, 4.6), line(2.8, 4.6, 4.2, 0),
          line(4.2, 0, 5.6, 5)),
    glyph('x', 3.6, line(0, 5, 3.6, 0), line(0, 0, 3.6, 5)),
    glyph('y', 3.8, line(0, 5, 1.9, 0), line(3.8, 5, 1, -2.4)),
    glyph('z', 3.6, line(0, 5, 3.6, 5), line(3.6, 5, 0, 0), line(0, 0, 3.6, 0)),
    glyph('0', 4.2, Stroke{2.1, 3.8, 2.1, 3.8, 0, 360}),
    glyph('1', 2.4, line(0.2, 6.2, 2, 7.6), line(2, 7.6, 2, 0)),
    glyph('2', 4.2, Stroke{2.1, 5.5, 2, 2.1, -35, 170}, line(3.74, 4.3, 0.1, 0),
          line(0.1, 0, 4.2, 0)),
    glyph('3', 4, Stroke{1.9, 5.75, 1.8, 1.85, -90, 150}, Stroke{1.9, 1.95, 2, 1.95, -150, 90}),
    glyph('4', 4.4, line(3.2, 0, 3.2, 7.6), line(3.2, 7.6, 0, 2.1), line(0, 2.1, 4.4, 2.1)),
    glyph('5', 4, line(3.7, 7.6, 0.6, 7.6), line(0.6, 7.6, 0.3, 4.2),
          Stroke{1.8, 2.45, 2.1, 2.45, -150, 135}),
    glyph('6', 4.2, Stroke{2.1, 2.4, 2.1, 2.4, 0, 360}, line(0.15, 3.2, 3.1, 7.6)),
    glyph('7', 4, line(0, 7.6, 4, 7.6), line(4, 7.6, 1.2, 0)),
    glyph('8', 4.2, Stroke{2.1, 5.75, 1.8, 1.85, 0, 360}, Stroke{2.1, 1.95, 2.1, 1.95, 0, 360}),
    glyph('9', 4.2, Stroke{2.1, 5.2, 2.1, 2.4, 0, 360}, line(4.05, 4.4, 1.1, 0)),
    glyph('/', 3, line(0, -1, 3, 8.2)),
    glyph('.', 0.6, line(0.3, 0.2, 0.3, 0.3))};

const Glyph* find_glyph(char letter) {
  const auto found = std::ranges::find(kGlyphs, letter, &Glyph::letter);
  return found == kGlyphs.end() ? nullptr : &*found;
}

double advance(char letter) {
  const Glyph* glyph = find_glyph(letter);
  return (glyph == nullptr ? kSpace : glyph->width) + kGap;
}

Vec2 point_of(const Stroke& stroke, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return {stroke.x + stroke.rx * std::cos(angle), stroke.y + stroke.ry * std::sin(angle)};
}

/// Calls visit(from, to) for the straight pieces of a stroke.
template <class Visit>
void for_each_piece(const Stroke& stroke, Visit visit) {
  if (stroke.from == kLine) return visit(Vec2(stroke.x, stroke.y), Vec2(stroke.rx, stroke.ry));
  const int pieces = static_cast<int>(std::ceil((stroke.to - stroke.from) / kMaxPiece));
  const double step = (stroke.to - stroke.from) / pieces;
  for (int k = 0; k < pieces; ++k)
    visit(point_of(stroke, stroke.from + k * step), point_of(stroke, stroke.from + (k + 1) * step));
}

void append_glyph(std::vector<FlatTriangle>& drawing, const Glyph& glyph, const Vec2& origin,
                  double unit, const Pen& pen) {
  const auto place = [&](const Vec2& p) { return Vec2(origin + unit * Vec2(p.x(), -p.y())); };
  for (const Stroke& stroke : std::span(glyph.strokes).first(glyph.count)) {
    for_each_piece(stroke, [&](const Vec2& from, const Vec2& to) {
      append_line(drawing, {place(from), place(to)}, pen.width * unit, pen.colour);
    });
  }
}

}  // namespace

double text_width(std::string_view text, double size) {
  double width = text.empty() ? 0 : -kGap;
  for (const char letter : text) width += advance(letter);
  return width * size / kFontUnits;
}

void append_text(std::vector<FlatTriangle>& drawing, std::string_view text, const Vec2& start,
                 double size, const Pen& pen) {
  const double unit = size / kFontUnits;
  Vec2 origin = start;
  for (const char letter : text) {
    if (const Glyph* glyph = find_glyph(letter)) append_glyph(drawing, *glyph, origin, unit, pen);
    origin.x() += unit * advance(letter);
  }
}

}  // namespace unwrapd::figure
