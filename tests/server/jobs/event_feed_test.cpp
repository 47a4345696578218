// The event ring: readers get every event once and in order, or a gap that says what they missed;
// whoever publishes never waits.
#include "server/jobs/event_feed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <future>
#include <thread>

namespace unwrapd::server::jobs {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::chrono::seconds kLong{60};  // never waited for when the feed works

void publish_iteration(JobFeed& feed, int iteration) {
  feed.publish([&](std::int64_t seq) {
    IterationEvent event;
    event.iteration = iteration;
    return api::iteration_event(seq, event, 0);
  });
}

void publish_end(JobFeed& feed) {
  feed.publish([](std::int64_t seq) {
    return api::final_event(seq, {.id = "j_1", .state = api::JobState::succeeded});
  });
}

int count(const std::string& text, const std::string& word) {
  int found = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

TEST(EventFeed, AReaderGetsEveryEventInOrderAndThenTheEnd) {
  JobFeed feed(0, 100);
  for (int i = 1; i <= 3; ++i) publish_iteration(feed, i);
  publish_end(feed);
  const Reading reading = feed.read(feed.resume_after({}));
  EXPECT_EQ(reading.last_seq, 4);
  EXPECT_TRUE(reading.end);
  EXPECT_EQ(reading.frames.find("id: 1\n"), 0U);
  EXPECT_LT(reading.frames.find("id: 3\n"), reading.frames.find("event: succeeded"));
  EXPECT_THAT(reading.frames, Not(HasSubstr("gap")));
}

TEST(EventFeed, AReaderGoesOnAfterTheLastEventItHasSeen) {
  JobFeed feed(0, 100);
  for (int i = 1; i <= 5; ++i) publish_iteration(feed, i);
  const Reading reading = feed.read(feed.resume_after(3));
  EXPECT_EQ(count(reading.frames, "event: iteration"), 2);
  EXPECT_EQ(reading.frames.find("id: 4\n"), 0U);
  EXPECT_FALSE(reading.end);
}

TEST(EventFeed, AReaderThatIsTooSlowIsToldWhatItMissed) {
  JobFeed feed(0, 4);
  for (int i = 1; i <= 10; ++i) publish_iteration(feed, i);
  const Reading reading = feed.read(feed.resume_after(2));
  EXPECT_EQ(reading.frames.find("id: 6\nevent: gap\ndata: {\"first\":3,\"last\":6}"), 0U);
  EXPECT_EQ(count(reading.frames, "event: iteration"), 4);
  EXPECT_EQ(reading.last_seq, 10);
}

TEST(EventFeed, ALaterAttemptGoesOnCounting) {
  EventFeed events;
  const auto feed = events.open("j_1", 2);
  publish_iteration(*feed, 1);
  EXPECT_EQ(feed->read(feed->resume_after({})).frames.find("id: 2000000001\n"), 0U);
  // A reader of an earlier attempt learns that there is a gap.
  const Reading resumed = feed->read(feed->resume_after(1'000'000'007));
  EXPECT_EQ(resumed.frames.find("id: 2000000000\nevent: gap"), 0U);
}

TEST(EventFeed, AReaderThatHasSeenTheEndSeesItAgain) {
  JobFeed feed(0, 100);
  publish_iteration(feed, 1);
  publish_end(feed);
  const Reading reading = feed.read(feed.resume_after(2));
  EXPECT_EQ(reading.frames.find("id: 2\nevent: succeeded"), 0U);
  EXPECT_TRUE(reading.end);
}

TEST(EventFeed, AnIdFromTheFutureStartsFromTheFirst) {
  JobFeed feed(0, 100);
  publish_iteration(feed, 1);
  EXPECT_EQ(feed.read(feed.resume_after(999)).frames.find("id: 1\n"), 0U);
}

TEST(EventFeed, NothingFollowsTheFinalEvent) {
  JobFeed feed(0, 100);
  publish_end(feed);
  publish_iteration(feed, 1);
  EXPECT_EQ(feed.next_seq(), 2);
}

TEST(EventFeed, AReadingIsIdleWhenNothingHappens) {
  const JobFeed feed(0, 100);
  const Reading reading = feed.read(0);
  EXPECT_THAT(reading.frames, IsEmpty());
  EXPECT_FALSE(reading.end);
}

TEST(EventFeed, EndingEndsReadersAndWaitsWithoutAFinalEvent) {
  EventFeed events;
  const auto feed = events.open("j_1", 0);
  bool finished = true;
  std::jthread waiting(
      [&] { finished = feed->wait_finished(std::chrono::steady_clock::now() + kLong); });
  events.end_all();
  waiting.join();
  EXPECT_FALSE(finished);
  const Reading reading = feed->read(0);
  EXPECT_TRUE(reading.end);
  EXPECT_THAT(reading.frames, IsEmpty());
}

TEST(EventFeed, TheBellRingsAtEventsAndAtTheEndOfAll) {
  const auto bell = std::make_shared<Wakeup>();
  const auto has_rung = [&] {
    pollfd polled{bell->descriptor(), POLLIN, 0};
    const bool rung = ::poll(&polled, 1, 0) == 1;
    bell->answer();
    return rung;
  };
  EventFeed events(16, 2, nullptr, bell);
  const auto feed = events.open("j_1", 0);
  EXPECT_FALSE(has_rung());
  publish_iteration(*feed, 1);
  publish_iteration(*feed, 2);
  EXPECT_TRUE(has_rung());
  EXPECT_FALSE(has_rung());
  events.end_all();
  EXPECT_TRUE(has_rung());
}

TEST(EventFeed, AReadingIsShortAndTheNextGoesOn) {
  JobFeed feed(0, 1000);
  for (int i = 1; i <= 500; ++i) publish_iteration(feed, i);
  int frames = 0;
  for (Reading reading = feed.read(0); !reading.frames.empty();
       reading = feed.read(reading.last_seq)) {
    EXPECT_LT(reading.frames.size(), 8192U);
    frames += count(reading.frames, "event: iteration");
  }
  EXPECT_EQ(frames, 500);
}

TEST(EventFeed, OldFinishedFeedsMakeRoomForNewOnes) {
  EventFeed events(16, 2);
  for (const char* job : {"j_1", "j_2", "j_3"}) {
    publish_end(*events.open(job, 0));
    events.retire(job);
  }
  EXPECT_FALSE(events.find("j_1"));
  EXPECT_TRUE(events.find("j_2"));
  EXPECT_TRUE(events.find("j_3"));
}

/// What one node publishes, as another is told of it.
class SharedFeeds : public testing::Test {
 protected:
  SharedFeeds() {
    here_.share_with([this](const store::EventRow& event) { told_.push_back(event); },
                     [](const std::string&) {});
    there_.share_with([](const store::EventRow&) {},
                      [this](const std::string& job) {
                        for (const store::EventRow& event : told_) there_.find(job)->append(event);
                        there_.find(job)->set_caught_up();
                      });
  }
  static store::JobRecord running() {
    store::JobRecord job;
    job.id = "j_1";
    job.state = api::JobState::running;
    return job;
  }

  std::vector<store::EventRow> told_;
  EventFeed here_;
  EventFeed there_;
};

TEST_F(SharedFeeds, AReaderElsewhereGetsTheSameEvents) {
  const auto feed = here_.open("j_1", 0);
  publish_iteration(*feed, 1);
  feed->set_progress({.stage = Stage::solve, .iteration = 2});
  publish_iteration(*feed, 2);
  const auto followed = there_.find_or_follow(running());
  EXPECT_EQ(followed->read(0).frames, feed->read(0).frames);
  EXPECT_EQ(followed->progress()->iteration, 2);
  publish_end(*feed);
  followed->append(told_.back());
  EXPECT_TRUE(followed->read(0).end);
  EXPECT_EQ(followed->read(0).frames, feed->read(0).frames);
  EXPECT_THAT(there_.following(), IsEmpty()) << "it is over";
}

TEST_F(SharedFeeds, ASecondReaderGoesOnWhereItWas) {
  const auto feed = here_.open("j_1", 0);
  for (int k = 1; k <= 3; ++k) publish_iteration(*feed, k);
  EventFeed slow;
  std::promise<void> is_followed, may_answer;
  slow.share_with([](const store::EventRow&) {},
                  [&](const std::string& job) {
                    is_followed.set_value();
                    may_answer.get_future().wait();
                    for (const store::EventRow& event : told_) slow.find(job)->append(event);
                    slow.find(job)->set_caught_up();
                  });
  const std::jthread first([&] { slow.find_or_follow(running()); });
  is_followed.get_future().wait();
  auto second = std::async(std::launch::async, [&] { return slow.find_or_follow(running()); });
  EXPECT_EQ(second.wait_for(std::chrono::milliseconds(20)), std::future_status::timeout);
  may_answer.set_value();
  EXPECT_EQ(second.get()->resume_after(feed->newest()), feed->newest());
}

TEST_F(SharedFeeds, AnEventComesOnceAndNoneThatIsLate) {
  const auto feed = here_.open("j_1", 0);
  publish_iteration(*feed, 1);
  const auto followed = there_.find_or_follow(running());
  followed->append(told_.front());
  EXPECT_EQ(count(followed->read(0).frames, "event: iteration"), 1);
  followed->rise_to(kSeqsPerAttempt);
  publish_iteration(*feed, 2);
  followed->append(told_.back());
  EXPECT_EQ(count(followed->read(0).frames, "event: iteration"), 1) << "of an attempt before";
}

TEST_F(SharedFeeds, WhatWasLostOnTheWayIsToldAsAGap) {
  const auto feed = here_.open("j_1", 0);
  feed->rise_to(kSeqsOfRun);
  for (int k = 1; k <= 4; ++k) publish_iteration(*feed, k);
  told_.erase(told_.begin() + 1, told_.begin() + 3);
  const Reading reading = there_.find_or_follow(running())->read(0);
  EXPECT_THAT(reading.frames, HasSubstr("\"first\":1000002,\"last\":1000003"));
  EXPECT_EQ(count(reading.frames, "event: gap"), 1) << "none where a part of the numbers begins";
  EXPECT_EQ(count(reading.frames, "event: iteration"), 2);
  EXPECT_EQ(reading.last_seq, kSeqsOfRun + 4);
}

TEST_F(SharedFeeds, NumbersOfALaterAttemptLeaveNoGapForItsReaders) {
  const auto feed = here_.open("j_1", 0);
  publish_iteration(*feed, 1);
  feed->rise_to(kSeqsPerAttempt);
  publish_iteration(*feed, 2);
  const Reading reading = feed->read(1);
  EXPECT_EQ(reading.last_seq, kSeqsPerAttempt + 1);
  EXPECT_THAT(reading.frames, Not(HasSubstr("gap")));
}

TEST_F(SharedFeeds, NothingIsFollowedThatHasEndedOrRunsHere) {
  store::JobRecord ended = running();
  ended.state = api::JobState::failed;
  EXPECT_EQ(there_.find_or_follow(ended), nullptr);
  const auto own = here_.open("j_1", 0);
  EXPECT_EQ(here_.find_or_follow(running()), own);
  own->append({.job = "j_1", .seq = 7, .is_last = true, .frame = "late", .progress = {}});
  EXPECT_FALSE(own->read(0).end) << "of a node that does not know that it has lost the job";
}

TEST(EventFeed, ManyReadersOfABusyFeedMissNothingUntold) {
  constexpr int kEvents = 5000;
  JobFeed feed(0, 64);
  std::atomic<int> complete = 0;
  std::vector<std::jthread> readers;
  for (int r = 0; r < 4; ++r) {
    readers.emplace_back([&] {
      std::int64_t after = 0;
      bool end = false;
      bool in_order = true;
      while (!end) {
        const Reading reading = feed.read(after);
        in_order = in_order && reading.last_seq >= after;
        const bool gap = reading.frames.find("event: gap") != std::string::npos;
        const int frames = count(reading.frames, "\n\n") - (gap ? 1 : 0);
        in_order = in_order && (gap || reading.last_seq - after == frames);
        after = reading.last_seq;
        end = reading.end;
      }
      if (in_order && after == kEvents + 1) ++complete;
    });
  }
  for (int i = 1; i <= kEvents; ++i) publish_iteration(feed, i);
  publish_end(feed);
  readers.clear();
  EXPECT_EQ(complete, 4);
}

}  // namespace
}  // namespace unwrapd::server::jobs
