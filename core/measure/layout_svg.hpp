#pragma once
// The UV layout as a picture: every triangle of the page, coloured by its distortion.

#include <span>
#include <string>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// An SVG document of the page [0,1]^2, V pointing up. A triangle's colour tells its distortion,
/// the boundary of every island is drawn, flipped triangles stand out.
/// unwrapped has one entry for each surface.
std::string layout_svg(std::span<const Surface> surfaces,
                       std::span<const UnwrappedSurface> unwrapped);

}  // namespace unwrapd
