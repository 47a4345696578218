#include "core/segment/base/progress_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace unwrapd::segment {
namespace {

constexpr double kSure = 0.7;  // of a guess: beyond, the rest is never quite used up

}  // namespace

void ProgressEstimate::begin(double share_of_rest, double guess) {
  begin_ = end_;
  end_ += share_of_rest * (1 - end_);
  guess_ = std::max(guess, 1.0);
  done_ = 0;
  add(0);
}

void ProgressEstimate::add(std::size_t faces) {
  done_ += static_cast<double>(faces);
  if (tell_) tell_(share());
}

double ProgressEstimate::share() const {
  const double x = done_ / guess_;
  const double of_part = x < kSure ? x : 1 - (1 - kSure) * std::exp(-(x - kSure) / (1 - kSure));
  return begin_ + (end_ - begin_) * of_part;
}

}  // namespace unwrapd::segment
