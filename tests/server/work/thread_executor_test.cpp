#include "server/work/thread_executor.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace unwrapd::server::work {
namespace {

TEST(ThreadExecutor, RunsEveryBlockOnceOnAnyNumberOfThreads) {
  for (const int threads : {1, 2, 4}) {
    ThreadExecutor executor(threads);
    for (const int blocks : {0, 1, 2, 7, 1000}) {
      std::vector<std::atomic<int>> runs(static_cast<std::size_t>(blocks));
      executor.for_each_block(blocks, [&](int b) { ++runs[static_cast<std::size_t>(b)]; });
      for (const auto& count : runs) EXPECT_EQ(count, 1) << threads << " threads";
    }
  }
}

TEST(ThreadExecutor, EveryRoundIsCompleteBeforeTheNextBegins) {
  ThreadExecutor executor(3);
  std::vector<int> values(64, 0);
  for (int round = 0; round < 2000; ++round) {
    executor.for_each_block(64, [&](int b) {
      int& value = values[static_cast<std::size_t>(b)];
      EXPECT_EQ(value, round);  // plain writes: a race would show, here or under TSan
      value = round + 1;
    });
  }
}

TEST(ThreadExecutor, ManyCanBeMadeAndLeftIdle) {
  for (int i = 0; i < 50; ++i) ThreadExecutor executor(4);
}

}  // namespace
}  // namespace unwrapd::server::work
