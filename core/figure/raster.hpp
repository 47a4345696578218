#pragma once
// Flat drawings in pixels: triangles and lines of one colour each, the later over the earlier.

#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/figure/image.hpp"
#include "core/figure/scan.hpp"

namespace unwrapd::figure {

struct FlatTriangle {
  ScreenTriangle corners;
  Rgb colour;
};

/// The outline of a line: eight corners, clockwise as seen; it has flattened round ends. Of these,
/// corners 0 to 3 lie about `to`, 4 to 7 about `from`. Pixels.
std::array<Vec2, 8> line_outline(const Vec2& from, const Vec2& to, double width);

/// The same in triangles.
void append_line(std::vector<FlatTriangle>& drawing, const std::array<Vec2, 2>& ends, double width,
                 const Rgb& colour);

/// A line with flat ends, in two triangles: for many thin lines that meet.
void append_thin_line(std::vector<FlatTriangle>& drawing, const std::array<Vec2, 2>& ends,
                      double width, const Rgb& colour);

/// An axis-parallel rectangle, pixels.
void append_rectangle(std::vector<FlatTriangle>& drawing, const Vec2& low, const Vec2& high,
                      const Rgb& colour);

/// A drawing's width and height in pixels, both >= 1, and what is behind it: nothing, so that it is
/// transparent, or a colour.
struct Sheet {
  int width = 1;
  int height = 1;
  std::optional<Rgb> background;
};

/// The picture, anti-aliased. Throws Error{cancelled} once a stop was requested.
Image rasterised(std::span<const FlatTriangle> drawing, const Sheet& sheet,
                 const std::stop_token& stop = {});

/// A picture of one colour, to draw into.
Image blank_image(int width, int height);

}  // namespace unwrapd::figure
