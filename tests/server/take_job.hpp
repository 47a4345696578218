#pragma once
// The next job of a queue, for a worker that helps with no other.

#include <memory>

#include "server/jobs/job_queue.hpp"

namespace unwrapd::server {

/// Waits for it; nullptr when the queue is closed.
inline std::shared_ptr<jobs::RunningJob> take_job(jobs::JobQueue& queue) {
  return queue.take_turn(false).job;
}

}  // namespace unwrapd::server
