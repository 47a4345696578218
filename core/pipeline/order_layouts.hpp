#pragma once
// Puts the layouts of a list of lambdas in order, as they are measured on the page.

#include <vector>

#include "core/pipeline/layout.hpp"

namespace unwrapd::pipeline {

/// Charts are in order before they are packed (map_chart.hpp). Straightening, rounding and a scale
/// that all charts share may break the order of the whole: such a layout is replaced by that of the
/// nearest lambda possible. layouts: measured, in the order of the list. A layout notes how many of
/// its charts have maps of other lambdas. Does nothing without a list, or for a given number of
/// iterations. Throws Error{cancelled}.
void order_layouts(std::vector<Layout>& layouts, const UnwrapOptions& options, Executor& executor);

}  // namespace unwrapd::pipeline
