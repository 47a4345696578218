#pragma once
// The methods that Table 1 compares with, and SLIM. Each has a file of its own.

#include "core/solve/solve.hpp"
#include "core/types/options.hpp"

namespace unwrapd::solve {

/// Solves one disk by options.method, which is not ASAP, ARAP or Hybrid. Only SLIM reads
/// options.stop; the other options are not used. Throws Error{solver_failed, cancelled}.
Solution other_method(const Disk& disk, const SolveOptions& options, const SolveWatch& watch,
                      Executor& executor);

}  // namespace unwrapd::solve
