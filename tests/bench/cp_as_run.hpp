#pragma once
// CP as its authors probably ran it for Table 1 (ADR 0013): found by trying, kept to be compared
// with, no method of ours. Differs from core/solve/cp in three ways: an edge is scaled by the
// arithmetic mean of exp(u) at its ends; triples of lengths of no triangle become flat, cos being
// cut at 1 and -1; the map is the least-squares solution of one equation a face,
//   z_i - z_k = r (z_j - z_k),  r = |ki| / |kj| exp(i angle at k),  k the face's third corner,
// divided by the size of the face's three coefficients, the two farthest vertices held.

#include "core/solve/base/disk.hpp"

namespace unwrapd::bench {

/// In disk units, any scale; flips are left. Throws Error{solver_failed}.
UvMap cp_as_run(const solve::Disk& disk);

}  // namespace unwrapd::bench
