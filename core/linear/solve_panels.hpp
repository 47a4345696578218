#pragma once
// The two sweeps of a solve over the panels of a factor.

#include <memory>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/linear/analysis.hpp"

namespace unwrapd::linear {

/// x, in the order of elimination: b becomes the solution of L L^T x = b. The same bits for any
/// executor.
void solve_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                  Executor& executor);

/// Which supernodes own one of these columns or lie above one that does: one entry a supernode.
std::vector<char> supernodes_over(const Analysis& analysis, std::span<const Index> columns);

/// Its halves: x becomes L^-1 x, and L^-T x. Supernodes that are not among `over` are passed by:
/// down they must have nothing but zeros to give, up their own rows are left as they were. Empty:
/// all are visited.
void descend_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                    std::span<const char> over, Executor& executor);
void ascend_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                   std::span<const char> over, Executor& executor);

}  // namespace unwrapd::linear
