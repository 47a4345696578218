#pragma once
// A thread that does one thing again and again until it is destroyed.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "server/base/log.hpp"

namespace unwrapd::server {

class Periodic {
 public:
  /// Does it at once, and then after each pause. What it throws is logged under this name, and it
  /// is tried again.
  Periodic(const std::string& name, std::chrono::milliseconds pause, std::function<void()> action,
           const Log& log);

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace unwrapd::server
