#pragma once
// Threads that act by the clock, and the priority of threads.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "server/base/log.hpp"

namespace unwrapd::server {

/// A thread that runs an action again and again until it is destroyed.
class Periodic {
 public:
  /// Runs the action at once, and then after each pause. What it throws is logged under this name;
  /// the next run comes as usual.
  Periodic(const std::string& name, std::chrono::milliseconds pause, std::function<void()> action,
           const Log& log);

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;  // last: it uses the others
};

/// Calls late() once if it still exists after the given time.
class Deadline {
 public:
  Deadline(std::chrono::seconds time, std::function<void()> late);

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watch_;  // last: it uses the others
};

/// Lowers the priority of this thread and of all threads and processes that it starts. It cannot be
/// raised again. Work on meshes calls this, so that answers, which take microseconds, need not wait
/// for a turn of milliseconds.
void give_way();

}  // namespace unwrapd::server
