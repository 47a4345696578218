#pragma once
// The bounds of distortion that are searched for one after another (ADR 0039).

#include <optional>
#include <vector>

namespace unwrapd::segment {

/// The excess over 2 of each bound on the way to max_distortion, ascending. The first is searched
/// for by itself, the others go on from the one before. From kDefaultDistortion on, the steps are
/// the same for every bound as far as they go, and the last one is at most max_distortion; a
/// tighter bound is the only one.
std::vector<double> excess_steps(double max_distortion);

/// The bound of the step before the last one; nothing where there is but one.
std::optional<double> tighter_bound(double max_distortion);

}  // namespace unwrapd::segment
