#include "server/retry_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace unwrapd::server {

int RetryEstimate::promise(Clock::time_point now, double mean_seconds) {
  using Seconds = std::chrono::duration<double>;
  const Seconds apart(mean_seconds / workers_);
  const auto latest = now + std::chrono::duration_cast<Clock::duration>(apart * places_);
  const auto next = std::max(promised_, now) + std::chrono::duration_cast<Clock::duration>(apart);
  promised_ = std::min(next, latest);
  const Seconds wait = promised_ - now;
  return std::max(1, static_cast<int>(std::ceil(wait.count())));
}

}  // namespace unwrapd::server
