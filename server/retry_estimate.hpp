#pragma once
// When a refused sender is to come back. A place in a full queue becomes free whenever a worker
// takes a job: every mean / workers seconds. Each sender is promised a place of its own, so that a
// hundred who were refused at once do not come back at once for one place.

#include <chrono>

namespace unwrapd::server {

/// Not for use by two threads at once.
class RetryEstimate {
 public:
  using Clock = std::chrono::steady_clock;

  /// workers: jobs that run at once; places: of the queue, and the most promises open at a time.
  RetryEstimate(int workers, int places) : workers_(workers), places_(places) {}

  /// Whole seconds, at least 1, until a place that nobody else was promised is free, if jobs take
  /// mean_seconds each.
  int promise(Clock::time_point now, double mean_seconds);

 private:
  const int workers_;
  const int places_;
  Clock::time_point promised_{};
};

}  // namespace unwrapd::server
