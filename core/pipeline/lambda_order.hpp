#pragma once
// Which maps a list of lambdas gets: along ascending lambdas D_angle does not fall, and D_area does
// not rise.

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/types/report.hpp"

namespace unwrapd::pipeline {

/// A map on the scale between keeping angles and keeping areas.
struct Tradeoff {
  double angle = 2;        ///< D_angle
  double area = 2;         ///< D_area
  std::size_t lambda = 0;  ///< for which it was found, by its place among ascending lambdas
};

/// The relative cost of a candidate, by its index, in place of a lambda's own map, >= 0.
using CandidateCost = std::function<double(std::size_t lambda, std::size_t candidate)>;

/// Whether D_angle never falls by more than the slack, and D_area never rises by more. The slack
/// is absolute up to D = 4, and grows with D above.
bool is_ordered(std::span<const Tradeoff> maps, double slack);

/// Chooses a candidate for each lambda so that the chosen ones are ordered within the slack and the
/// sum of their costs is least. Of two candidates out of order, one without more distortion of
/// either kind than the other excludes it.
std::vector<std::size_t> choose_in_order(std::span<const Tradeoff> candidates,
                                         std::size_t lambda_count, double slack,
                                         const CandidateCost& cost);

}  // namespace unwrapd::pipeline
