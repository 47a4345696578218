#pragma once
// Worker processes that wait for the jobs to come, started, given their limits and locked in
// (sandbox.hpp): a job need not wait until its own has found its libraries. Each is for one job.

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "server/work/started_worker.hpp"

namespace unwrapd::server::work {

/// Thread-safe. All processes are started by one thread of its own: they die with that thread, and
/// those that ask for them come and go.
class SpareWorkers {
 public:
  /// Keeps count processes that start() makes.
  SpareWorkers(int count, std::function<StartedWorker()> start);
  SpareWorkers(const SpareWorkers&) = delete;
  SpareWorkers& operator=(const SpareWorkers&) = delete;
  ~SpareWorkers() = default;

  /// The one that has waited longest, if there is one; another takes its place at once. It may
  /// have ended while it waited.
  [[nodiscard]] std::optional<StartedWorker> take();

 private:
  void keep(const std::stop_token& stop);
  [[nodiscard]] std::optional<StartedWorker> started() const;

  const std::size_t count_;
  const std::function<StartedWorker()> start_;
  std::mutex mutex_;
  std::condition_variable_any wanted_;
  bool has_failed_ = false;  // to start one; tried again when one is asked for
  std::deque<StartedWorker> spares_;
  std::jthread keeping_;
};

}  // namespace unwrapd::server::work
