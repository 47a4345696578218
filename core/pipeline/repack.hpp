#pragma once
// The UVs that surfaces came with, on a page of their own again or where they are.

#include <span>

#include "core/base/executor.hpp"
#include "core/types/progress.hpp"
#include "core/types/report.hpp"

namespace unwrapd::pipeline {

/// Packs the islands of the surfaces' corner_uv; none is deformed or mirrored. At a given density
/// each has it; else they keep their sizes beside each other. With measure_only they stay where
/// they are, and the report counts overlaps between islands, too.
/// Throws Error{no_texture_coordinates, does_not_fit, cancelled}.
Unwrapped repack(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const Progress& progress, Executor& executor);

}  // namespace unwrapd::pipeline
