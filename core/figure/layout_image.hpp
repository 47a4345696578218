#pragma once
// The UV layout as a picture of pixels: what layout_svg() draws, without a program that reads SVG.

#include <span>
#include <stop_token>

#include "core/figure/colour_scale.hpp"
#include "core/figure/image.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

/// The page, or the square about it that shows all islands, has a longer side of `size` pixels, in
/// [1, kMaxImageSize]; the picture is as much higher as the legend takes. Where it is
/// cropped, a pixel's corner lies at each multiple of 1/size in UVs. Places that two triangles
/// share are hatched, but not in a wireframe. unwrapped has one entry for each surface. Throws
/// Error{cancelled} once a stop was requested.
Image layout_image(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
                   const LayoutLook& look, int size, const std::stop_token& stop = {});

}  // namespace unwrapd::figure
