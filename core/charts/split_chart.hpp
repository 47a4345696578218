#pragma once
// One chart made two, where its map covers the page twice or cannot be mended.

#include <array>
#include <stop_token>
#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::charts {

/// A part of a chart: again a disk (holes allowed).
struct ChartPart {
  Chart chart;
  std::vector<Index> face;    ///< part face -> face of the chart that was split
  std::vector<Index> vertex;  ///< part vertex -> vertex of that chart
};

/// The pieces that hang together by the twins in `cut`, which are some of the chart's own (it need
/// not be a disk): ordered by their lowest face, faces ascending, corners in their order.
/// Throws Error{cancelled}.
std::vector<ChartPart> parts_of(const Chart& chart, const Halfedges& cut,
                                const std::stop_token& stop = {});

/// Parts the faces so that those of seeds[0] and of seeds[1] are in different parts: each face goes
/// with the seeds that are nearer over the surface. Seeds are disjoint, none empty; where a part
/// would fall to pieces, there are more than two. Every face is in exactly one part, with its
/// corners in their order.
std::vector<ChartPart> split_chart(const Chart& chart,
                                   const std::array<std::vector<Index>, 2>& seeds,
                                   const std::stop_token& stop = {});

}  // namespace unwrapd::charts
