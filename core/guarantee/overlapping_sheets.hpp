#pragma once
// Which parts of a chart lie on each other.

#include <array>
#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::guarantee {

/// Two sheets of the chart that lie on each other: disjoint sets of faces, none of them empty. If
/// the overlapping faces fall into regions that are not connected, the two regions with the most
/// pairs between them; else what surrounds the first pair without lying on itself. pairs: of
/// overlapping faces, one at least.
std::array<std::vector<Index>, 2> overlapping_sheets(
    const charts::Chart& chart, const std::vector<std::array<Index, 2>>& pairs);

}  // namespace unwrapd::guarantee
