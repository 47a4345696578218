#pragma once
// The part of the plane that a chart's map covers, as segments.

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::charts {

/// Closed loops of directed segments. A point is inside if its winding number is not zero.
using Outline = std::vector<std::array<Vec2, 2>>;

/// The chart's boundary loops, and the sides of flipped triangles, which may reach beyond them.
Outline outline_of(const Chart& chart, std::span<const Vec2> uv);

/// Where each segment starts: each corner of its loops once.
UvMap points_of(std::span<const std::array<Vec2, 2>> outline);

/// Its least and its greatest coordinates.
std::pair<Vec2, Vec2> bounds_of(const Outline& outline);

/// Of all loops, by the shoelace formula: above 0 for those that run counterclockwise.
double area_of(const Outline& outline);

}  // namespace unwrapd::charts
