#pragma once
// Core's Executor over threads of our own. Idle threads wait in the kernel: spinning ones were
// measured to slow a busy neighbour fivefold.

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/executor.hpp"

namespace unwrapd::server::work {

/// Runs blocks on `threads` threads, the caller's included. For one caller at a time.
class ThreadExecutor final : public Executor {
 public:
  /// core: what the jobs run here share with others; null: nothing.
  explicit ThreadExecutor(int threads, SharedCache* core = nullptr);
  ThreadExecutor(const ThreadExecutor&) = delete;
  ThreadExecutor& operator=(const ThreadExecutor&) = delete;
  ~ThreadExecutor() override;

  void for_each_block(int block_count, const std::function<void(int)>& body) override;
  [[nodiscard]] SharedCache* shared_cache() const override { return core_; }

 private:
  void serve(const std::stop_token& stop);
  void take_blocks(const std::function<void(int)>& body, int block_count);

  SharedCache* const core_;
  std::mutex mutex_;
  std::condition_variable_any work_;                // a new round, or the end
  std::condition_variable done_;                    // no helper is in the round any more
  const std::function<void(int)>* body_ = nullptr;  // set while a round can be joined
  int block_count_ = 0;
  std::atomic<int> next_block_ = 0;
  unsigned round_ = 0;
  int helpers_in_round_ = 0;
  std::vector<std::jthread> helpers_;
};

}  // namespace unwrapd::server::work
