#pragma once
// The two sweeps of a solve over the panels of a factor.

#include <memory>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/linear/analysis.hpp"

namespace unwrapd::linear {

/// Solves L L^T x = b in place; x is in the order of elimination. The same bits for any executor.
void solve_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                  Executor& executor);

/// One entry a supernode: 1 if it owns one of these columns or lies above one that does.
std::vector<char> supernodes_over(const Analysis& analysis, std::span<const Index> columns);

/// The two halves: x becomes L^-1 x, and L^-T x. Supernodes outside of `over` are skipped: in the
/// first half their entries must be zero, in the second their rows stay as they were. Empty: all
/// are visited.
void descend_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                    std::span<const char> over, Executor& executor);
void ascend_panels(const Analysis& analysis, const double* panels, std::span<Vec2> x,
                   std::span<const char> over, Executor& executor);

}  // namespace unwrapd::linear
