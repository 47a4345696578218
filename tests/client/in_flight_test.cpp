#include "client/in_flight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <numeric>
#include <set>
#include <stdexcept>

namespace unwrapd::client {
namespace {

/// Workers that begin the jobs in the order in which they come.
class Workers {
 public:
  explicit Workers(int count) {
    for (int k = 0; k < count; ++k)
      threads_.emplace_back([this](std::stop_token stop) { work(stop); });
  }
  ~Workers() {
    for (std::jthread& thread : threads_) thread.request_stop();
    changed_.notify_all();
  }

  /// Returns when the job has ended.
  void run(std::size_t number, const InFlight::OnBegun& on_begun) {
    Job job;
    std::unique_lock lock(mutex_);
    numbers_.push_back(number);
    waiting_.push_back(&job);
    most_at_once_ = std::max(most_at_once_, ++at_once_);
    changed_.notify_all();
    changed_.wait(lock, [&] { return job.has_begun; });
    lock.unlock();
    on_begun();
    lock.lock();
    job.is_told = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return job.has_ended; });
    --at_once_;
  }

  std::size_t most_at_once() const { return most_at_once_; }
  std::vector<std::size_t> numbers() const { return numbers_; }

 private:
  struct Job {
    bool has_begun = false, is_told = false, has_ended = false;
  };

  void work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return stop.stop_requested() || !waiting_.empty(); });
      if (stop.stop_requested()) return;
      Job& job = *waiting_.front();
      waiting_.pop_front();
      job.has_begun = true;
      changed_.notify_all();
      changed_.wait(lock, [&] { return job.is_told; });
      job.has_ended = true;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job*> waiting_;
  std::vector<std::size_t> numbers_;
  std::size_t at_once_ = 0, most_at_once_ = 0;
  std::vector<std::jthread> threads_;
};

std::set<std::size_t> all_below(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return {numbers.begin(), numbers.end()};
}

TEST(InFlight, RunsEachTaskOnceAndNoMoreAtOnceThanIsFixed) {
  Workers workers(8);
  InFlight(3).run(200, [&](std::size_t k, const auto& on_begun) { workers.run(k, on_begun); });
  const auto numbers = workers.numbers();
  EXPECT_EQ(numbers.size(), 200U);
  EXPECT_EQ(std::set(numbers.begin(), numbers.end()), all_below(200));
  EXPECT_LE(workers.most_at_once(), 3U);
}

TEST(InFlight, LetsAsManyWaitAsHaveBegunAndFourAtLeast) {
  constexpr int kAll = 60;
  std::atomic<int> taken = 0, may_begin = 0;
  std::atomic<bool> may_end = false;
  std::jthread run([&] {
    InFlight(0).run(kAll, [&](std::size_t k, const auto& on_begun) {
      ++taken;
      while (static_cast<int>(k) >= may_begin) std::this_thread::yield();
      on_begun();
      while (!may_end) std::this_thread::yield();
    });
  });
  for (const int begun : {0, 1, 3, 5, 12}) {
    may_begin = begun;
    const int expected = begun + std::max(4, begun);
    while (taken < expected) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // for more, which must not come
    EXPECT_EQ(taken, expected);
  }
  may_begin = kAll;
  may_end = true;
  run.join();
  EXPECT_EQ(taken, kAll);
}

TEST(InFlight, KeepsWorkersBusyWithoutAFixedNumber) {
  for (const int count : {1, 3, 16}) {
    Workers workers(count);
    InFlight(0).run(500, [&](std::size_t k, const auto& on_begun) { workers.run(k, on_begun); });
    EXPECT_EQ(workers.numbers().size(), 500U);
    EXPECT_GE(workers.most_at_once(), std::size_t(count));
  }
}

/// Nothing ends before all workers have a job: so many must come of themselves.
TEST(InFlight, FindsEveryWorker) {
  constexpr int kWorkers = 40;
  std::atomic<int> begun = 0;
  InFlight(0).run(60, [&](std::size_t, const auto& on_begun) {
    on_begun();
    ++begun;
    while (begun < kWorkers) std::this_thread::yield();
  });
  EXPECT_EQ(begun, 60);
}

TEST(InFlight, TasksThatEndBeforeTheyBeginKeepNoneFromFollowing) {
  std::atomic<int> ended = 0;
  InFlight(0).run(100, [&](std::size_t, const auto&) { ++ended; });
  EXPECT_EQ(ended, 100);
}

TEST(InFlight, BeginsNoTaskAfterOneThrew) {
  std::atomic<int> begun = 0;
  const auto task = [&](std::size_t k, const auto&) {
    ++begun;
    if (k == 5) throw std::runtime_error("five");
  };
  InFlight one(1);
  EXPECT_THROW(one.run(100, task), std::runtime_error);
  EXPECT_EQ(begun, 6);
  begun = 0;
  one.run(3, task);  // and can be used again
  EXPECT_EQ(begun, 3);
}

TEST(InFlight, NothingToDoIsDoneAtOnce) {
  InFlight(0).run(0, [](std::size_t, const auto&) { FAIL(); });
}

}  // namespace
}  // namespace unwrapd::client
