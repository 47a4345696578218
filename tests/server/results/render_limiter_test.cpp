// Who may make a file now, with real threads that wait.
#include "server/results/render_limiter.hpp"

#include <gtest/gtest.h>

#include <future>
#include <thread>
#include <vector>

#include "server/base/errors.hpp"

namespace unwrapd::server::results {
namespace {

using Place = std::shared_ptr<void>;

/// Somebody who waits, or has a place.
class Waiter {
 public:
  Waiter(RenderLimiter& room, const RenderRequest& making)
      : place_(std::async(std::launch::async, [&room, making] { return room.enter(making); })) {}

  [[nodiscard]] bool is_in(std::chrono::milliseconds patience = std::chrono::minutes(1)) {
    return place_.wait_for(patience) == std::future_status::ready;
  }
  [[nodiscard]] bool still_waits() { return !is_in(std::chrono::milliseconds(20)); }
  void leave() { place_.get().reset(); }

 private:
  std::future<Place> place_;
};

TEST(RenderLimiter, AFileIsMadeByOneAtATime) {
  RenderLimiter room({.places = 8, .waiting = 8, .bytes = 100});
  Waiter first(room, {.file = "a", .holder = "x"});
  ASSERT_TRUE(first.is_in());
  Waiter second(room, {.file = "a", .holder = "y"});
  EXPECT_TRUE(second.still_waits());
  Waiter other(room, {.file = "b", .holder = "y"});
  EXPECT_TRUE(other.is_in());
  other.leave();
  first.leave();
  EXPECT_TRUE(second.is_in());
  second.leave();
}

TEST(RenderLimiter, NobodyHasMoreThanHalfOfThePlaces) {
  RenderLimiter room({.places = 4, .waiting = 8, .bytes = 100});
  Waiter a(room, {.file = "a", .holder = "x"}), b(room, {.file = "b", .holder = "x"});
  ASSERT_TRUE(a.is_in() && b.is_in());
  Waiter c(room, {.file = "c", .holder = "x"});
  EXPECT_TRUE(c.still_waits());
  Waiter d(room, {.file = "d", .holder = "y"}), e(room, {.file = "e", .holder = "z"});
  EXPECT_TRUE(d.is_in() && e.is_in());
  a.leave();
  EXPECT_TRUE(c.is_in());
  Waiter f(room, {.file = "f", .holder = "z"});
  EXPECT_TRUE(f.still_waits());  // all four are taken
  for (Waiter* each : {&b, &c, &d, &e}) each->leave();
  EXPECT_TRUE(f.is_in());
  f.leave();
}

TEST(RenderLimiter, WhatNeedsMoreMemoryThanThereIsHasItAloneAndIsNotOvertaken) {
  RenderLimiter room({.places = 8, .waiting = 8, .bytes = 100});
  Waiter small(room, {.file = "a", .holder = "x", .bytes = 60});
  ASSERT_TRUE(small.is_in());
  Waiter large(room, {.file = "b", .holder = "y", .bytes = 1000});
  EXPECT_TRUE(large.still_waits());
  Waiter late(room, {.file = "c", .holder = "z", .bytes = 1});
  EXPECT_TRUE(late.still_waits());
  small.leave();
  EXPECT_TRUE(large.is_in());
  EXPECT_TRUE(late.still_waits());
  large.leave();
  EXPECT_TRUE(late.is_in());
  late.leave();
}

TEST(RenderLimiter, WhoFindsTooManyWaitingIsTurnedAway) {
  RenderLimiter room({.places = 2, .waiting = 4, .bytes = 100});
  Waiter a(room, {.file = "a", .holder = "x"});
  ASSERT_TRUE(a.is_in());
  std::vector<std::jthread> passers;
  for (int i = 0; i < 2; ++i)
    passers.emplace_back([&] { room.enter({.file = "a", .holder = "x"}).reset(); });
  while (room.waiting() < 2) std::this_thread::yield();
  try {
    static_cast<void>(room.enter({.file = "d", .holder = "x"}));  // half of those who wait are x's
    ADD_FAILURE() << "waits";
  } catch (const RetryLater& error) {
    EXPECT_EQ(error.code(), ErrorCode::rate_limited);
    EXPECT_GT(error.seconds(), 0);
  }
  EXPECT_NO_THROW(room.enter({.file = "e", .holder = "y"}).reset());
  a.leave();
}

}  // namespace
}  // namespace unwrapd::server::results
