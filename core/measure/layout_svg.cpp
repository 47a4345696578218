// The layout as text: triangles go into one path for each colour, so the document has about twenty
// elements however large the mesh. Coordinates are whole tenths of 1/4096 of the page, written with
// std::to_chars relative to a triangle's first corner, which keeps them short.
#include "core/measure/layout_svg.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/measure/jacobian.hpp"
#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd {
namespace {

constexpr double kUnits = 40960;  // coordinates a page's side
constexpr double kWorst = 4;      // distortion at which the last colour begins
constexpr std::size_t kColourCount = 12;

constexpr long kLegendLeft = 128, kSwatchWidth = 192;  // in 1/4096 of the page's side

/// Lightness falls evenly in OKLCH, hue goes from green over blue to violet: ordered in grey too.
constexpr std::array<std::string_view, kColourCount> kColours{
    "#d1fdc7", "#a5f0bc", "#74e2ba", "#35d2bc", "#00c0c0", "#00abc1",
    "#0094be", "#007db5", "#1d66a5", "#32518e", "#383e74", "#352e57"};
constexpr std::string_view kFlippedColour = "#ff2a4d";
constexpr std::string_view kInk = "#16131f";

/// What the picture is made of: the data of its paths.
struct Paths {
  std::array<std::string, kColourCount> colour;
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

Point point_at(const Vec2& uv) {
  return {std::lround(kUnits * uv.x()), std::lround(kUnits * uv.y())};
}

void append_line(std::string& text, const Point& from, const Point& to) {
  append_point(text, 'l', to[0] - from[0], to[1] - from[1]);
}

void append_triangle(std::string& text, const Triangle& face, const UvMap& uv) {
  const Point a = point_at(uv[face[0]]), b = point_at(uv[face[1]]), c = point_at(uv[face[2]]);
  append_point(text, 'M', a[0], a[1]);
  append_line(text, a, b);
  append_line(text, b, c);
  text += 'z';
}

/// The face laid flat; area 0 when it has none.
RestTriangle laid_flat(const Vec3& a, const Vec3& b, const Vec3& c) {
  RestTriangle rest;
  const double base = (b - a).norm(), twice_area = (b - a).cross(c - a).norm();
  if (!(twice_area > 0)) return rest;
  const double foot = (b - a).dot(c - a) / base, height = twice_area / base;
  rest.edge = {Vec2(-base, 0), Vec2(base - foot, -height), Vec2(foot, height)};
  rest.area = twice_area / 2;
  return rest;
}

/// Calls visit(surface number, face number, area, jacobian) for every face with an area.
template <class Visit>
void for_each_face(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
                   Visit visit) {
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const auto& positions = surfaces[s].mesh.positions;
    for (std::size_t t = 0; t < surfaces[s].mesh.faces.size(); ++t) {
      const auto& [a, b, c] = surfaces[s].mesh.faces[t];
      const RestTriangle rest = laid_flat(positions[a], positions[b], positions[c]);
      if (!(rest.area > 0)) continue;
      const Triangle& face = unwrapped[s].faces[t];
      visit(s, t, rest.area, jacobian(rest, uv_edges(face, unwrapped[s].uv)));
    }
  }
}

/// The scale of UVs that makes UV area = 3D area.
double common_scale(std::span<const Surface> surfaces,
                    std::span<const UnwrappedSurface> unwrapped) {
  double area = 0, uv_area = 0;
  for_each_face(surfaces, unwrapped, [&](std::size_t, std::size_t, double a, const Jacobian& j) {
    area += a;
    uv_area += a * std::abs(j.determinant());
  });
  return uv_area > 0 ? std::sqrt(area / uv_area) : 1;
}

/// max(sigma_max, 1 / |sigma_min|) on a logarithmic scale from 1 to kWorst.
std::size_t colour_of(const Jacobian& j, double scale) {
  const double worst = std::max(scale * j.sigma_max(), 1 / (scale * std::abs(j.sigma_min())));
  const double place = (kColourCount - 1) * std::log(worst) / std::log(kWorst);
  return static_cast<std::size_t>(std::clamp(place, 0.0, kColourCount - 1.0));
}

/// The edges that have a face on one side only: found by place on the page, since vertices may be
/// split for other reasons than a seam.
void append_boundaries(const UnwrappedSurface& surface, std::string& text) {
  std::vector<Vec3> places(surface.uv.size());
  for (std::size_t v = 0; v < places.size(); ++v) places[v] << surface.uv[v], 0;
  const std::vector<Triangle> faces = renumbered(surface.faces, weld(places));
  auto sides = edge_sides(faces, [&](Index h) { return !repeats_vertex(faces[face_of(h)]); });
  sort_by_edge(sides, static_cast<Index>(places.size()));
  for_each_run(sides, on_one_edge, [&](const EdgeSide* first, const EdgeSide* last) {
    if (last - first > 1) return;
    const Point a = point_at(surface.uv[first->low]), b = point_at(surface.uv[first->high]);
    append_point(text, 'M', a[0], a[1]);
    append_line(text, a, b);
  });
}

Paths draw(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped) {
  Paths paths;
  const double scale = common_scale(surfaces, unwrapped);
  for_each_face(surfaces, unwrapped, [&](std::size_t s, std::size_t t, double, const Jacobian& j) {
    std::string& path = j.determinant() < 0 ? paths.flipped : paths.colour[colour_of(j, scale)];
    append_triangle(path, unwrapped[s].faces[t], unwrapped[s].uv);
  });
  for (const UnwrappedSurface& surface : unwrapped) append_boundaries(surface, paths.boundary);
  return paths;
}

/// Triangles of one colour. A stroke of that colour hides the hairlines between neighbours.
void append_fill(std::string& svg, std::string_view colour, std::string_view data) {
  if (data.empty()) return;
  svg.append("<path fill=\"").append(colour).append("\" stroke=\"").append(colour);
  svg.append("\" stroke-width=\"5\" d=\"").append(data).append("\"/>\n");
}

void append_boundary(std::string& svg, std::string_view data) {
  svg.append("<path fill=\"none\" stroke=\"").append(kInk);
  svg.append("\" stroke-width=\"30\" d=\"").append(data).append("\"/>\n");
}

void append_swatch(std::string& svg, long x, long width, std::string_view colour) {
  svg += "<rect y=\"4160\" height=\"96\" x=\"";
  append(svg, x);
  svg += "\" width=\"";
  append(svg, width);
  svg.append("\" fill=\"").append(colour).append("\"/>\n");
}

void append_label(std::string& svg, long x, std::string_view label) {
  svg += "<text y=\"4352\" x=\"";
  append(svg, x);
  svg.append("\">").append(label).append("</text>\n");
}

/// Below the page: the colours with their distortion, and the colour of flipped triangles.
void append_legend(std::string& svg) {
  svg += "<g font-family=\"sans-serif\" font-size=\"88\" fill=\"#16131f\">\n";
  for (std::size_t k = 0; k < kColourCount; ++k)
    append_swatch(svg, kLegendLeft + static_cast<long>(k) * kSwatchWidth, kSwatchWidth,
                  kColours[k]);
  append_label(svg, kLegendLeft, "1: true to shape and size");
  append_label(svg, kLegendLeft + (kColourCount - 1) * kSwatchWidth, "4 or more");
  append_swatch(svg, kLegendLeft + 15 * kSwatchWidth, kSwatchWidth, kFlippedColour);
  append_label(svg, kLegendLeft + 15 * kSwatchWidth, "flipped");
  svg += "</g>\n";
}

}  // namespace

std::string layout_svg(std::span<const Surface> surfaces,
                       std::span<const UnwrappedSurface> unwrapped) {
  assert(surfaces.size() == unwrapped.size());
  const Paths paths = draw(surfaces, unwrapped);
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 4096 4416\">\n"
      "<title>UV layout, coloured by distortion</title>\n"
      "<rect width=\"4096\" height=\"4416\" fill=\"#ffffff\"/>\n"
      "<rect width=\"4096\" height=\"4096\" fill=\"#f3f2f5\"/>\n"
      "<g transform=\"matrix(.1 0 0 -.1 0 4096)\" stroke-linejoin=\"round\">\n";
  for (std::size_t k = 0; k < kColourCount; ++k) append_fill(svg, kColours[k], paths.colour[k]);
  append_fill(svg, kFlippedColour, paths.flipped);
  append_boundary(svg, paths.boundary);
  svg += "</g>\n";
  append_legend(svg);
  svg += "</svg>\n";
  return svg;
}

}  // namespace unwrapd
