#pragma once
// How many jobs of several are at the server at once.

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace unwrapd::client {

/// Runs tasks in their order, each in a thread, side by side. Without a fixed number it follows the
/// workers: as many tasks wait for one as have begun, and four at least, so that a worker which
/// ends a job always finds another.
class InFlight {
 public:
  using OnBegun = std::function<void()>;
  /// Called with the task's number, and what to call once its job has begun.
  using Task = std::function<void(std::size_t, const OnBegun&)>;

  static constexpr int kMost = 256;  ///< tasks at once

  /// fixed: tasks at once; 0: as many as the workers need.
  explicit InFlight(int fixed) : fixed_(static_cast<std::size_t>(fixed)) {}

  /// Runs tasks 0, 1, ... count - 1. After a task threw, no other begins, and its exception is
  /// thrown again once all have ended.
  void run(std::size_t count, const Task& task);

 private:
  void work();
  void perform(std::size_t number, std::unique_lock<std::mutex>& lock);
  [[nodiscard]] bool is_over() const { return next_ == count_ || end_; }
  [[nodiscard]] bool may_take() const;
  /// Adds a thread if there is a task for it.
  void grow();

  std::size_t fixed_;
  const Task* task_ = nullptr;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::jthread> threads_;
  std::size_t count_ = 0, next_ = 0;
  std::size_t waiting_ = 0, begun_ = 0, idle_ = 0, working_ = 0;
  std::exception_ptr end_;
};

}  // namespace unwrapd::client
