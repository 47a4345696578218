// The part of job_queue.hpp that tells how much waits, also while the store is away.
#include <algorithm>

#include "core/base/error.hpp"
#include "server/base/clock.hpp"
#include "server/jobs/job_queue.hpp"

namespace unwrapd::server::jobs {

store::QueueCounts JobQueue::counts() {
  const std::lock_guard lock(mutex_);
  return counts_if_reached();
}

store::QueueCounts JobQueue::counts_if_reached() {
  try {
    counted_ = store_.counts();
  } catch (const Error&) {  // it is told elsewhere that the store is away
  }
  return counted_;
}

double JobQueue::waiting_seconds() {
  const std::lock_guard lock(mutex_);
  try {
    first_waiting_ms_ = store_.first_waiting_ms();
  } catch (const Error&) {  // it is told elsewhere that the store is away
  }
  if (!first_waiting_ms_) return 0;
  const auto waited_ms = static_cast<double>(now_ms() - *first_waiting_ms_);
  return std::max(0.0, waited_ms / kMsPerSecond);
}

}  // namespace unwrapd::server::jobs
