#pragma once
// The parts of a chart that the guarantee took apart, each at its own rest.

#include <stop_token>
#include <vector>

#include "core/pipeline/parameterize_chart.hpp"

namespace unwrapd::pipeline {

/// A small part may have given way to the rest of its chart, and be distorted much, where the whole
/// is not. Parts with twice the mean excess of all are solved once more, from their maps, as charts
/// of their own; what comes of it is taken where it has the guarantee, in one piece, and less
/// distortion. A part that cannot be solved stays as it is, and so does a single one. Throws
/// Error{cancelled}.
void settle_parts(const UnwrapOptions& options, double lambda, const std::stop_token& stop,
                  Executor& executor, std::vector<MappedChart>& parts);

}  // namespace unwrapd::pipeline
