#include "server/jobs/watchdog.hpp"

#include <utility>

namespace unwrapd::server::jobs {

Watchdog::Watchdog(const std::stop_token& stop, const WatchTimes& times, WatchDuties functions)
    : stop_(stop),
      watch_([this, times, functions = std::move(functions)](const std::stop_token& end) {
        watch(end, times, functions);
      }),
      wake_at_stop_(stop, [this] {
        const std::lock_guard lock(mutex_);
        wake_.notify_all();
      }) {}

void Watchdog::watch(const std::stop_token& end, const WatchTimes& times,
                     const WatchDuties& functions) {
  {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, end, times.limit, [&] { return stop_.stop_requested(); });
  }
  if (end.stop_requested()) return;
  if (!stop_.stop_requested()) functions.late();
  {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, end, times.grace, [] { return false; });
  }
  if (!end.stop_requested()) functions.overdue();
}

}  // namespace unwrapd::server::jobs
