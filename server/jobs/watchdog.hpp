#pragma once
// The time of one job: told to stop when it is up, and given up when it does not stop then.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace unwrapd::server::jobs {

struct WatchTimes {
  std::chrono::seconds limit;
  std::chrono::seconds grace;
};

/// What a watchdog does; called from a thread of its own, each once at most.
struct WatchDuties {
  std::function<void()> late;  ///< after `limit`; asks for the stop
  std::function<void()>
      overdue;  ///< when the job is at work so long after its stop as `grace` says
};

/// Watches while it exists.
class Watchdog {
 public:
  /// stop: of the job, whoever asks for it.
  Watchdog(const std::stop_token& stop, const WatchTimes& times, WatchDuties functions);

 private:
  void watch(const std::stop_token& end, const WatchTimes& times, const WatchDuties& functions);

  const std::stop_token stop_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watch_;                                      // it uses the others
  std::stop_callback<std::function<void()>> wake_at_stop_;  // last: it wakes the thread
};

}  // namespace unwrapd::server::jobs
