#pragma once
// The UV layout as a drawing: every triangle of the page, coloured by its distortion.

#include <span>
#include <stop_token>
#include <string>

#include "core/figure/colour_scale.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

/// An SVG document of the page in a square of 4096 units, or in its own shape where it is cropped,
/// V pointing up, with a legend below. A triangle's colour tells its figure (see shown_value())
/// after one global scale that makes UV area = 3D area; the boundary of every island is drawn,
/// flipped triangles lie on top in a colour of their own, places that two triangles share are
/// hatched, faces without area in 3D are left out. The page is a greater square where islands lie
/// outside it. unwrapped has one entry for each surface.
std::string layout_svg(std::span<const Surface> surfaces,
                       std::span<const UnwrappedSurface> unwrapped, const LayoutLook& look = {},
                       const std::stop_token& stop = {});

}  // namespace unwrapd::figure
