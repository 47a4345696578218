#pragma once
// Core has no threads of its own: it splits its loops into blocks and hands them to an Executor.
// Through it a job also reaches what it shares with others.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <stop_token>
#include <utility>

#include "core/base/cancel.hpp"

namespace unwrapd {

class SharedCache;
class SharedWork;

class Executor {
 public:
  Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;
  virtual ~Executor() = default;

  /// Calls body(block) once for every block in [0, block_count), in any order and on any thread;
  /// returns when all are done. body must not throw. Of a job that was told to stop: calls no
  /// further blocks and throws Error{cancelled}.
  virtual void for_each_block(int block_count, const std::function<void(int)>& body) = 0;

  /// What jobs share (shared_cache.hpp); null where this one is alone. Outlives the job.
  [[nodiscard]] virtual SharedCache* shared_cache() const { return nullptr; }

  /// What other processes help with (shared_work.hpp); null: they do not. Outlives the job.
  [[nodiscard]] virtual SharedWork* shared_work() const { return nullptr; }

  /// Of the job whose blocks these are: long work looks at it (cancel.hpp).
  [[nodiscard]] virtual std::stop_token stop() const { return {}; }
};

/// How many steps of a loop are a block: fixed, so that no sum depends on threads.
inline constexpr std::size_t kPartSize = 4096;

/// How many parts `count` steps come to.
constexpr std::size_t part_count(std::size_t count) { return (count + kPartSize - 1) / kPartSize; }

/// Calls body(part, begin, end) for every part of [0, count), as blocks.
template <class Body>
void for_each_part(std::size_t count, Executor& executor, Body body) {
  executor.for_each_block(static_cast<int>(part_count(count)), [&](int block) {
    const auto part = static_cast<std::size_t>(block);
    const std::size_t begin = part * kPartSize;
    body(part, begin, std::min(begin + kPartSize, count));
  });
}

/// Another executor, for one job that may be told to stop.
class JobExecutor final : public Executor {
 public:
  /// inner must outlive this.
  JobExecutor(Executor& inner, std::stop_token stop) : inner_(inner), stop_(std::move(stop)) {}

  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    throw_if_cancelled(stop_);
    inner_.for_each_block(block_count, [&](int block) {
      if (!is_cancelled(stop_)) body(block);
    });
    throw_if_cancelled(stop_);
  }
  [[nodiscard]] SharedCache* shared_cache() const override { return inner_.shared_cache(); }
  [[nodiscard]] SharedWork* shared_work() const override { return inner_.shared_work(); }
  [[nodiscard]] std::stop_token stop() const override { return stop_; }

 private:
  Executor& inner_;
  std::stop_token stop_;
};

/// Runs the blocks one after another on the calling thread.
class SerialExecutor final : public Executor {
 public:
  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    for (int block = 0; block < block_count; ++block) body(block);
  }
};

}  // namespace unwrapd
