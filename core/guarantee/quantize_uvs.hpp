#pragma once
// Page UVs as every format writes them, without a triangle lost to rounding.

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::guarantee {

/// UVs are multiples of this: for those in [0, 1] both v and 1 - v are floats, so that neither
/// writing V downwards (glTF) nor upwards (OBJ) rounds again.
inline constexpr double kUvStep = 0x1p-24;

/// kUvStep, or where constraints put UVs beyond [0, 1] the power of two at which the same holds.
double uv_step(const UvMap& uv);

/// Every UV to the nearest multiple of uv_step(), whatever becomes of the triangles. Where
/// constrained[v] (one a vertex, or empty), each coordinate is as exact as it can be written: to
/// the step that uv_step() says of it alone.
void round_to_step(UvMap& uv, std::span<const char> constrained = {});

/// Every UV on the page to the nearest multiple of uv_step(); uv is a chart's map without flips.
/// Triangles that would flip or vanish by that are made a few steps larger, at their neighbours'
/// expense; vertices with constrained[v] (one a vertex, or empty) are only rounded, as by
/// round_to_step(). Returns how many triangles are not counter-clockwise in the end. Throws
/// Error{cancelled}.
Index quantize_uvs(const charts::Chart& chart, const std::vector<char>& constrained,
                   const std::stop_token& stop, UvMap& uv);

}  // namespace unwrapd::guarantee
