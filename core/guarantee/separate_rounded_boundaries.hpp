#pragma once
// Gaps that rounding closed, opened again.

#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::guarantee {

/// page_uv: a chart's UVs after quantize_uvs(), without flips. Where triangles overlap because
/// rounding closed a gap between two stretches of boundary, both draw back, by a few steps of
/// uv_step() and then by more, up to some hundred; vertices with constrained[v] (one a vertex, or
/// empty) stay. Returns whether nothing overlaps in the end; no triangle is flipped by this, and
/// where it is false nothing has moved. Throws Error{cancelled}.
bool separate_rounded_boundaries(const charts::Chart& chart, const std::vector<char>& constrained,
                                 UvMap& page_uv, const std::stop_token& stop = {});

}  // namespace unwrapd::guarantee
