#pragma once
// What the queue says to those whom it refuses, and of jobs that it gives up.

#include <cstdint>

#include "server/base/retry_later.hpp"

namespace unwrapd::server {

RetryLater draining();
RetryLater no_room(int seconds);
RetryLater queue_full(int places, int seconds);
RetryLater too_many_jobs(std::int64_t most, int seconds);
Error quota_exceeded(std::int64_t most_bytes);
Error unknown_job();
Error another_question();
Error cancelled_by_owner();
Error unreadable_job();
Error poison();

}  // namespace unwrapd::server
