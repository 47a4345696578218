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
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Interrupt interrupt(std::chrono::milliseconds(0));
    EXPECT_FALSE(interrupt.token().stop_requested());
    kill(getpid(), signal);
    await(interrupt.token());
    EXPECT_FALSE(interrupt.timed_out());
  }
}

TEST(Interrupt, LeavesASignalAloneThatIsIgnored) {  // by nohup
  sigset_t hangup, blocked;
  sigemptyset(&hangup);
  sigaddset(&hangup, SIGHUP);
  pthread_sigmask(SIG_UNBLOCK, &hangup, nullptr);
  const auto before = std::signal(SIGHUP, SIG_IGN);
  {
    const Interrupt interrupt(std::chrono::milliseconds(0));
    pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
    EXPECT_FALSE(sigismember(&blocked, SIGHUP));
  }
  std::signal(SIGHUP, before);
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
