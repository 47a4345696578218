#pragma once
// Gaps that rounding closed, opened again.

#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd {

/// page_uv: a chart's UVs after snap(), without flips. Where triangles overlap because rounding
/// closed a gap between two stretches of boundary, both draw back, by a few steps of uv_step() and
/// then by more, up to some hundred; vertices with held[v] (one a vertex, or empty) stay. Returns
/// whether nothing overlaps in the end; no triangle is flipped by this, and where it is false
/// nothing has moved.
bool part_on_page(const Chart& chart, const std::vector<char>& held, UvMap& page_uv);

}  // namespace unwrapd
