#pragma once
// Surfaces where a scene shows them.

#include <span>
#include <vector>

#include "core/mesh/placement.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

struct Scene {
  std::vector<Surface> surfaces;  ///< only their meshes
  std::vector<UnwrappedSurface> unwrapped;
};

/// One surface for each that is shown, in its place. Where a placement mirrors it, the winding of
/// its faces is turned, so that their outer sides stay outside. Left out is what lies beyond all
/// numbers.
Scene in_scene(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
               std::span<const ShownSurface> shown);

}  // namespace unwrapd::figure
