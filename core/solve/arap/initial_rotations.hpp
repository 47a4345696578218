#pragma once
// A nearly isometric start: rotates every triangle first, then joins all by one global step.

#include "core/solve/arap/global_step.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::arap {

/// The map that one global step makes of triangles rotated as in a conformal map that keeps lengths
/// on the boundary to first order (see initial_rotations.cpp). Exact on developable disks; may have
/// flips elsewhere. global: the system of the disk without constraints. Throws
/// Error{solver_failed}.
UvMap map_from_rotations(const Disk& disk, const GlobalStep& global);

}  // namespace unwrapd::solve::arap
