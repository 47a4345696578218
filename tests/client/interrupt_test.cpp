#include "client/interrupt.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <csignal>
#include <mutex>

namespace unwrapd::client {
namespace {

void await(const std::stop_token& token) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any never_notified;
  never_notified.wait(lock, token, [] { return false; });
}

TEST(Interrupt, ASignalRequestsAStop) {
  const Interrupt interrupt(std::chrono::milliseconds(0));
  EXPECT_FALSE(interrupt.token().stop_requested());
  kill(getpid(), SIGINT);
  await(interrupt.token());
  EXPECT_FALSE(interrupt.timed_out());
}

TEST(Interrupt, TheTimeLimitRequestsAStop) {
  const Interrupt interrupt(std::chrono::milliseconds(1));
  await(interrupt.token());
  EXPECT_TRUE(interrupt.timed_out());
}

TEST(Interrupt, EndsQuietlyWhenNothingHappens) {
  const Interrupt interrupt(std::chrono::milliseconds(0));
  EXPECT_FALSE(interrupt.token().stop_requested());
}

}  // namespace
}  // namespace unwrapd::client
