#pragma once
// The shortest seam that separates two sets of faces.

#include <array>
#include <stop_token>
#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::charts {

/// The twins of the chart's half-edges without those across the shortest seam, in length over the
/// surface, that leaves no way from a face of sets[0] to one of sets[1]. Lengths are rounded to a
/// thousandth of the mean edge; of equal seams the one nearest to sets[0] is taken. The sets are
/// disjoint and not empty. Throws Error{cancelled}.
Halfedges cut_between(const Chart& chart, const std::array<std::vector<Index>, 2>& sets,
                      const std::stop_token& stop = {});

}  // namespace unwrapd::charts
