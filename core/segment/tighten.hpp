#pragma once
// Bounds of distortion below kDefaultDistortion: its charts, split further.

#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"

namespace unwrapd::segment {

/// Bounds below kDefaultDistortion on the way to another, descending (ADR 0066).
struct TightBounds {
  std::vector<double> searched;  ///< one beyond the last step, where there is one and time for it
  std::size_t count = 0;         ///< of steps; what lies between two steps counts as the lower one
};

/// None from kDefaultDistortion on. Effort::fast searches for none beyond the last step.
TightBounds tight_bounds(double max_distortion, Effort effort);

/// The parts of a chart, each a disk with a start, that keep a bound of distortion together.
using SplitChart =
    std::function<std::vector<charts::Chart>(const charts::Chart& chart, double bound)>;

/// Splits the charts that are distorted most until all together keep `bound`. It only adds seams.
/// charts: of one component, each with a start. No more than `most` come out, unless more came in:
/// charts that would become too many stay whole. The same for any executor. Throws
/// Error{cancelled}.
std::vector<charts::Chart> tighten(std::vector<charts::Chart> charts, double bound, Index most,
                                   const SplitChart& split, Executor& executor,
                                   const std::stop_token& stop);

}  // namespace unwrapd::segment
