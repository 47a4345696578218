#pragma once
// The two sweeps of a solve over the panels of a factor.

#include <memory>
#include <span>
#include <vector>

#include "core/executor.hpp"
#include "core/linear/analysis.hpp"

namespace unwrapd {

/// x, in the order of elimination: b becomes the solution of L L^T x = b. The same bits for any
/// executor.
void solve_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                  Executor& executor);

}  // namespace unwrapd
