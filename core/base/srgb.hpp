#pragma once
// The transfer function of sRGB, IEC 61966-2-1.

#include <cmath>

namespace unwrapd {

/// The light, in [0, 1], for which sRGB stores a value in [0, 1].
inline double from_srgb(double stored) {
  return stored <= 0.04045 ? stored / 12.92 : std::pow((stored + 0.055) / 1.055, 2.4);
}

inline double to_srgb(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

}  // namespace unwrapd
