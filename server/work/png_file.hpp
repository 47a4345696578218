#pragma once
// Pictures as PNG files.

#include <string>

#include "core/figure/image.hpp"

namespace unwrapd::server::work {

/// The bytes of a PNG file, 8 bits a channel, sRGB, without a date: the same for the same
/// picture. Throws Error{internal} when there is no memory for it.
std::string encode_png(const figure::Image& image);

}  // namespace unwrapd::server::work
