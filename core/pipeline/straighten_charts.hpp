#pragma once
// Charts whose maps are nearly rectangles become rectangles.

#include "core/pipeline/layout.hpp"

namespace unwrapd::pipeline {

/// Where options ask for it. A chart stays as it is if its distortion would exceed max_distortion,
/// or kDefaultDistortion without one. Throws Error{cancelled}.
void straighten_charts(Layout& layout, const UnwrapOptions& options, Executor& executor);

}  // namespace unwrapd::pipeline
