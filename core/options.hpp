#pragma once
// What a user can ask for. Aggregates with defaults in place; validate() is the one check.

#include <cstdint>

namespace unwrapd {

enum class Method { asap, arap, hybrid };
enum class InitialMap { automatic, mean_value, tutte, lscm };  ///< automatic: "auto" on the wire
enum class Pins { diameter, spectral };
enum class LambdaUnits { dimensionless, paper };
enum class SeamMode { automatic, keep, none };  ///< automatic: "auto" on the wire

struct UnwrapOptions {
  Method method = Method::arap;
  double lambda = 0.1;  ///< hybrid only, >= 0: 0 is ASAP, infinity is ARAP
  LambdaUnits lambda_units = LambdaUnits::dimensionless;
  int iterations = 10;                         ///< local/global iterations a chart, >= 1
  InitialMap initial = InitialMap::automatic;  ///< see initial_maps()
  Pins pins = Pins::diameter;                  ///< ASAP only: how the conformal map is pinned
  SeamMode seams = SeamMode::automatic;        ///< which vertex copies are welded for topology
  int resolution = 1024;                       ///< side of the square page, texels, [16, 16384]
  int padding = 2;                             ///< gap between islands and to the border, texels
};

inline constexpr int kMinResolution = 16;
inline constexpr int kMaxResolution = 16384;

/// Throws Error{invalid_option} with the JSON pointer of the first option that is out of range.
void validate(const UnwrapOptions& options, int max_iterations);

}  // namespace unwrapd
