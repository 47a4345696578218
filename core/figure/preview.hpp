#pragma once
// The textured mesh as a picture: a checkerboard laid on the page and drawn on the surface, the
// usual way to see what a map does to angles and areas.

#include <optional>
#include <span>
#include <stop_token>

#include "core/figure/image.hpp"
#include "core/figure/view.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

/// A square picture of `size` pixels, in [kMinImageSize, kMaxImageSize], on white. Squares of the
/// checkerboard have one size on the page, chosen so that about kChecksAcross of them cross the
/// surface; seams are drawn pink and boundaries of the surface dark, both where they can be seen.
/// Surfaces lie where their own coordinates put them (see in_scene()). unwrapped has one entry for
/// each. aspect: from where they are seen; none: aslant, so that much is seen. Throws
/// Error{cancelled} once a stop was requested.
Image preview(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
              int size, const std::optional<Aspect>& aspect = {}, const std::stop_token& stop = {});

/// A sheet of kTurntableViews such pictures at one scale, from the front by equal turns to the
/// right, somewhat from above: two rows, `size` pixels wide or up to 3 less.
Image turntable(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
                int size, const std::stop_token& stop = {});

inline constexpr int kTurntableViews = 8;
inline constexpr double kTurntableElevation = 20;  ///< degrees

inline constexpr int kChecksAcross = 26;

inline constexpr Rgb kLightCheck = {0xfb, 0xf8, 0xf1};
inline constexpr Rgb kDarkCheck = {0x2f, 0x77, 0xa8};
inline constexpr Rgb kSeamColour = {0xff, 0x2d, 0x8e};

}  // namespace unwrapd::figure
