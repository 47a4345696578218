#pragma once
// The bounded queue of jobs and their life: queued -> running -> succeeded | failed | cancelled.
// The store is the truth and the order; this class adds the waiting, the stop requests and the
// events. A full queue refuses at once rather than let requests pile up.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "server/blob_store.hpp"
#include "server/event_feed.hpp"
#include "server/job_store.hpp"
#include "server/log.hpp"

namespace unwrapd::server {

/// Refused for now: the answer carries Retry-After.
class RetryLater : public Error {
 public:
  RetryLater(ErrorCode code, const std::string& message, int seconds)
      : Error(code, message), seconds_(seconds) {}
  [[nodiscard]] int seconds() const { return seconds_; }

 private:
  int seconds_;
};

enum class StopCause { none, cancelled, time_limit, draining };

/// A job in the hands of a worker.
struct RunningJob {
  JobRecord record;
  std::shared_ptr<JobFeed> feed;
  std::int64_t started_ms = 0;
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();
  std::stop_source stop;
  std::atomic<StopCause> cause = StopCause::none;

  /// Asks the worker to stop; the first cause counts.
  void request_stop(StopCause why);
};

struct QueueConfig {
  int max_queue = 256;
  int workers = 1;
};

/// Thread-safe.
class JobQueue {
 public:
  JobQueue(JobStore& store, BlobStore& blobs, EventFeed& events, const Log& log,
           const QueueConfig& config);

  /// Once, before any worker: what the last process left running waits again, or is given up.
  void recover();

  /// Throws RetryLater{queue_full, draining} when a submission would be refused now.
  void check_room();
  /// Stores a job whose upload is complete. Throws like check_room().
  JobRecord submit(JobRecord job);
  /// Waits for the oldest queued job; nullptr when the queue is closed.
  std::shared_ptr<RunningJob> take();
  /// Ends what take() returned. Its files are complete when it has succeeded.
  void finish(const RunningJob& job, JobOutcome outcome);

  /// Cancels a live job (true), or removes a finished one and its files (false). Throws not_found.
  bool cancel_or_remove(const std::string& id);

  /// No new jobs from now on; those waiting stay in the store for the next start.
  void close();
  /// Waits for the running jobs; those that are not done by then go back to the queue.
  void drain(std::chrono::seconds patience);
  [[nodiscard]] bool draining() const { return closed_; }

 private:
  void check_room_locked() const;
  [[nodiscard]] int retry_after_seconds() const;
  void enqueue(JobRecord& job);
  void give_up(const JobRecord& job, const Error& why);
  void wait_again(const JobRecord& job);
  void cancel_live(const JobRecord& job);
  void end_job(const JobRecord& job, JobOutcome outcome);

  JobStore& store_;
  BlobStore& blobs_;
  EventFeed& events_;
  const Log& log_;
  const QueueConfig config_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<bool> closed_ = false;
  std::int64_t waiting_ = 0;
  double mean_job_seconds_ = 1;
  std::map<std::string, std::shared_ptr<RunningJob>, std::less<>> running_;
};

}  // namespace unwrapd::server
