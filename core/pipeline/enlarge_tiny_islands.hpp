#pragma once
// Islands that would be too small for the precision in which UVs are written.

#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::pipeline {

/// A chart and its map, which is in units that all charts have in common.
struct SizedIsland {
  const charts::Chart* chart = nullptr;
  UvMap* map = nullptr;
};

/// Scales the maps of islands that are too small beside all others, so that a usual triangle has
/// some steps of guarantee::kUvStep a side: beside a terrain, a bolt keeps its maps. Such an island
/// is some texels wide at most.
void enlarge_tiny_islands(const std::vector<SizedIsland>& islands);

}  // namespace unwrapd::pipeline
