#pragma once
// Ctrl-C and the time limit, both as one stop token: whatever waits, waits for it too.

#include <atomic>
#include <chrono>
#include <stop_token>
#include <thread>

namespace unwrapd::client {

/// From its construction on, SIGINT and SIGTERM no longer end the process: they request a stop, as
/// does the passing of the time limit. Make it before any other thread.
class Interrupt {
 public:
  /// time_limit zero: none.
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
