#pragma once
// A time after which something is called.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace unwrapd::server {

/// Calls late() once when it still exists after a time.
class Deadline {
 public:
  Deadline(std::chrono::seconds time, std::function<void()> late);

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watch_;  // last: it uses the others
};

}  // namespace unwrapd::server
