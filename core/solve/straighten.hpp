#pragma once
// Makes rectangles of maps that are nearly rectangles.

#include <optional>
#include <span>

#include "core/solve/base/disk.hpp"

namespace unwrapd::solve {

/// The map with its boundary on a rectangle along the axes, of the same area, and with its inner
/// vertices moved smoothly. Empty if the boundary is no single loop that lies near the four sides
/// of a rectangle, or if a triangle would be flipped or lose its area. uv: in any units, without
/// flips. Throws Error{cancelled}.
std::optional<UvMap> straightened(const Disk& disk, std::span<const Vec2> uv);

}  // namespace unwrapd::solve
