#pragma once
// A disk that needs no seam.

#include <optional>
#include <stop_token>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"

namespace unwrapd::segment {

/// The map of a disk as one chart, if that has no flip and no overlap, by exact tests, and neither
/// D_angle nor D_area beyond max_distortion, less a margin for solving on. One solve of ARAP
/// decides it, whatever the size. UV area = 1. The same for any executor. Throws Error{cancelled}.
std::optional<UvMap> map_whole(const charts::Chart& disk, double max_distortion, Executor& executor,
                               const std::stop_token& stop);

}  // namespace unwrapd::segment
