#pragma once
// Islands onto their pages, and what the report says of it.

#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/outline.hpp"
#include "core/types/options.hpp"
#include "core/types/report.hpp"

namespace unwrapd::pipeline {

/// Packs the islands; maps (one an island, in the units of its outline) become page UVs. Fills the
/// report's fill and pages, and notes what could not be had.
/// Throws Error{does_not_fit, cancelled}.
void place_islands(std::span<const charts::Outline> outlines, const UnwrapOptions& options,
                   Executor& executor, std::span<UvMap* const> maps, Report& report);

}  // namespace unwrapd::pipeline
