#pragma once
// A start that is nearly isometric already: every triangle turned first, all stitched then.

#include "core/solve/arap/global_step.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::arap {

/// The map in which each triangle comes as close as one global step can bring it to its rest shape,
/// turned as in a conformal map that keeps lengths on the boundary to first order (see
/// initial_rotations.cpp). Exact on developable disks; may have flips elsewhere. global: that of
/// the disk without holds. Throws Error{solver_failed}.
UvMap map_from_rotations(const Disk& disk, const GlobalStep& global);

}  // namespace unwrapd::solve::arap
