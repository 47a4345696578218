#pragma once
// Jobs whose work several processes share (core/base/shared_work.hpp), on this node and on others.
// A worker for whom no job waits helps with a running one. It holds nobody up: it leaves as soon as
// a job waits, and a job waits for a helper no longer than the work would take itself.
//
// What a helper makes is used by the job that it helps with, and by no other: a mesh that takes a
// process over harms nobody else's result.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "server/base/log.hpp"
#include "server/store/job_store.hpp"
#include "server/work/work_desk.hpp"

namespace unwrapd::server::jobs {

/// Bundles of work, since the start.
struct SharingCounts {
  std::atomic<std::uint64_t> offered = 0;  ///< of stages that jobs of this node began to share
  std::atomic<std::uint64_t> helped = 0;   ///< made here for jobs that other processes answer for
  std::atomic<std::uint64_t> found = 0;    ///< taken from helpers by jobs of this node
  std::atomic<std::uint64_t> lost = 0;     ///< waited for in vain, and made again
};

/// A running job that a worker of this node helps with.
struct HelpedJob {
  store::JobRecord record;
  std::stop_source stop;
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();
};

/// Thread-safe.
class WorkSharing {
 public:
  /// tell: called when a job has work to share.
  WorkSharing(store::JobStore& store, const Log& log, std::function<void()> tell)
      : store_(store), log_(log), tell_(std::move(tell)) {}

  /// A job to help with, if there is one.
  std::shared_ptr<HelpedJob> find();
  /// Whether the job that is helped still runs. Throws what the store throws.
  [[nodiscard]] bool is_running(const HelpedJob& helped);
  /// Whether any job waits for a worker. Throws what the store throws.
  [[nodiscard]] bool is_any_waiting();
  /// Once the help has come to an end; failed: this node does not help with this job again.
  void leave(const HelpedJob& helped, bool failed);
  /// Stops all helping, for good.
  void close();

  /// The desk of the process that answers for a job, or of one that helps with it. Where the store
  /// fails, the job goes on alone. It must not outlive this.
  std::unique_ptr<work::WorkDesk> desk_of_job(const store::JobRecord& job, std::stop_token stop);
  std::unique_ptr<work::WorkDesk> desk_of_helper(const HelpedJob& helped);
  /// A job of this node has ended.
  void drop(const store::JobRecord& job);

  [[nodiscard]] const SharingCounts& counts() const { return counts_; }

 private:
  class Desk;

  store::JobStore& store_;
  const Log& log_;
  const std::function<void()> tell_;
  SharingCounts counts_;
  std::mutex mutex_;
  bool is_closed_ = false;
  std::vector<std::int64_t> failed_;  ///< the last jobs (their seq) with which help failed
  std::list<std::weak_ptr<HelpedJob>> helped_;
};

}  // namespace unwrapd::server::jobs
