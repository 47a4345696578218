#include "core/segment/excess_steps.hpp"

#include <algorithm>
#include <array>

#include "core/types/options.hpp"

namespace unwrapd::segment {
namespace {

constexpr std::array kSteps = {1.5, 2.0, 2.5, 3.5, 5.0, 7.5, 10.0};  // of excess, in each decade
constexpr int kDecades = 4;
constexpr double kSameBound = 1e-9;

}  // namespace

std::vector<double> excess_steps(double max_distortion) {
  std::vector<double> steps{std::min(max_distortion, kDefaultDistortion) - 2};
  double decade = kDefaultDistortion - 2;
  for (int k = 0; k < kDecades; ++k, decade *= 10)
    for (const double step : kSteps)
      if (2 + step * decade <= max_distortion + kSameBound) steps.push_back(step * decade);
  return steps;
}

std::optional<double> tighter_bound(double max_distortion) {
  const std::vector<double> steps = excess_steps(max_distortion);
  if (steps.size() < 2) return std::nullopt;
  return 2 + steps[steps.size() - 2];
}

}  // namespace unwrapd::segment
