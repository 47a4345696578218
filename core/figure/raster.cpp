#include "core/figure/raster.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "core/figure/bands.hpp"

namespace unwrapd::figure {

std::array<Vec2, 8> line_outline(const Vec2& from, const Vec2& to, double width) {
  const double length = (to - from).norm();
  const Vec2 along = length > 0 ? Vec2((to - from) / length) : Vec2(1, 0);
  const Vec2 across(-along.y(), along.x());
  const double radius = width / 2 / std::cos(std::numbers::pi / 8);
  std::array<Vec2, 8> corners;
  for (std::size_t k = 0; k < 8; ++k) {
    const double turn = (static_cast<double>(k) - 1.5) * std::numbers::pi / 4;
    corners[k] = (k < 4 ? to : from) + radius * (std::cos(turn) * along + std::sin(turn) * across);
  }
  return corners;
}

void append_line(std::vector<FlatTriangle>& drawing, const std::array<Vec2, 2>& ends, double width,
                 const Rgb& colour) {
  const std::array<Vec2, 8> corners = line_outline(ends[0], ends[1], width);
  for (std::size_t k = 2; k < corners.size(); ++k)
    drawing.push_back(
        {{snapped(corners[0]), snapped(corners[k - 1]), snapped(corners[k])}, colour});
}

void append_thin_line(std::vector<FlatTriangle>& drawing, const std::array<Vec2, 2>& ends,
                      double width, const Rgb& colour) {
  const Vec2 along = ends[1] - ends[0];
  const double length = along.norm();
  if (!(length > 0)) return;
  const Vec2 aside = Vec2(-along.y(), along.x()) * (width / 2 / length);
  const ScreenPoint a = snapped(ends[0] - aside), b = snapped(ends[1] - aside);
  const ScreenPoint c = snapped(ends[1] + aside), d = snapped(ends[0] + aside);
  drawing.push_back({{a, b, c}, colour});
  drawing.push_back({{a, c, d}, colour});
}

void append_rectangle(std::vector<FlatTriangle>& drawing, const Vec2& low, const Vec2& high,
                      const Rgb& colour) {
  const ScreenPoint a = snapped(low), c = snapped(high);
  const ScreenPoint b = {c[0], a[1]}, d = {a[0], c[1]};
  drawing.push_back({{a, b, c}, colour});
  drawing.push_back({{a, c, d}, colour});
}

Image blank_image(int width, int height) {
  assert(width >= 1 && height >= 1);
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  return {
      .width = width, .height = height, .rgb = std::vector<std::uint8_t>(3 * pixels), .alpha = {}};
}

Image rasterised(std::span<const FlatTriangle> drawing, const Sheet& sheet,
                 const std::stop_token& stop) {
  Image image = blank_image(sheet.width, sheet.height);
  if (!sheet.background) image.alpha.resize(image.rgb.size() / 3);
  draw_in_bands(
      {image, sheet.background.value_or(Rgb{}), stop}, static_cast<Index>(drawing.size()),
      [&](Index k) -> const ScreenTriangle& { return drawing[k].corners; },
      [&](Index k, Band& band) { band.fill(drawing[k].corners, drawing[k].colour); });
  return image;
}

}  // namespace unwrapd::figure
