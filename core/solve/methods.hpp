#pragma once
// The methods that Table 1 compares with, and SLIM: one file each.

#include "core/solve/solve.hpp"
#include "core/types/options.hpp"

namespace unwrapd::solve {

/// Solves one disk by options.method, which is none of ASAP, ARAP and Hybrid. Of the options only
/// stop counts, and that for SLIM.
/// Throws Error{solver_failed, cancelled}.
Solution other_method(const Disk& disk, const SolveOptions& options, const SolveWatch& watch,
                      Executor& executor);

}  // namespace unwrapd::solve
