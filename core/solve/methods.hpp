#pragma once
// The methods that Table 1 compares with, and SLIM: one file each.

#include "core/options.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd {

/// Solves one disk by a method other than ASAP, ARAP and Hybrid.
/// Throws Error{solver_failed, cancelled}.
Solution other_method(const Disk& disk, Method method, const SolveWatch& watch, Executor& executor);

}  // namespace unwrapd
