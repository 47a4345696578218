#pragma once
// Ctrl-C and the time limit as one stop token.

#include <atomic>
#include <chrono>
#include <stop_token>
#include <thread>

namespace unwrapd::client {

/// After its construction, SIGINT, SIGTERM, SIGHUP and the end of the time limit request a stop
/// instead of ending the process. Construct it before any other thread.
class Interrupt {
 public:
  /// time_limit zero: no limit.
  explicit Interrupt(std::chrono::milliseconds time_limit);
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  ~Interrupt();

  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }
  [[nodiscard]] bool timed_out() const { return timed_out_; }

 private:
  void watch(std::chrono::milliseconds time_limit);

  std::stop_source source_;
  std::atomic<bool> timed_out_ = false;
  int signals_ = -1;  ///< signalfd
  int finish_ = -1;   ///< eventfd, written by the destructor
  std::jthread watcher_;
};

}  // namespace unwrapd::client
