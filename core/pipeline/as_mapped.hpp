#pragma once
// A finished map beside the surfaces for which it was made: what its distortion is measured on.

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/repair_surfaces.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pipeline {

/// The surfaces as unwrap() repaired them before it mapped them; as given, where UVs are kept.
/// `unwrapped` comes with the winding of the file and leaves with that of the repaired surfaces: a
/// face that was turned is no flipped one. The result refers to the input. Throws Error{cancelled}.
charts::RepairedSurfaces as_mapped(std::span<const Surface> given, const UnwrapOptions& options,
                                   std::vector<UnwrappedSurface>& unwrapped,
                                   const std::stop_token& stop = {});

}  // namespace unwrapd::pipeline
