#pragma once
// Splits a chart whose map overlaps itself or cannot be repaired.

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

/// The parts that are connected by the twins in `cut`, which are a subset of the chart's own (it
/// need not be a disk). Parts are ordered by their lowest face, faces ascend, corners keep their
/// order. Throws Error{cancelled}.
std::vector<ChartPart> parts_of(const Chart& chart, const Halfedges& cut,
                                const std::stop_token& stop = {});

/// Splits the faces so that those of seeds[0] and of seeds[1] are in different parts: each face
/// goes with the seeds that are nearer over the surface. Seeds are disjoint and not empty. If a
/// part is not connected, there are more than two parts. Every face is in exactly one part, and its
/// corners keep their order.
std::vector<ChartPart> split_chart(const Chart& chart,
                                   const std::array<std::vector<Index>, 2>& seeds,
                                   const std::stop_token& stop = {});

}  // namespace unwrapd::charts
