// When somebody at the end of his quota is told to come back.
#include "server/jobs/admission.hpp"

#include <gmock/gmock.h>

#include <set>

#include "server/base/errors.hpp"

namespace unwrapd::server::jobs {
namespace {

constexpr double kSeconds = 10;  // of every job so far
constexpr http::Quota kTwoJobs{.max_jobs = 2};

/// A queue behind one worker, with room for anybody.
class Quotas : public testing::Test {
 protected:
  Quotas() {
    for (int k = 0; k < 400; ++k) state_.lengths.add(kSeconds);
  }

  void waits(const std::string& owner) {
    ++state_.counts.waiting;
    add(owner);
  }
  void runs(const std::string& owner) {
    ++state_.counts.running;
    add(owner);
  }

  /// Seconds after which this sender is to come back; 0 when he may come in.
  int told(std::string_view sender, std::int64_t live, const std::vector<AtWork>& running,
           const http::Quota& quota = kTwoJobs) {
    store::JobRecord job;
    job.owner = "his";
    job.stored_bytes = 5;
    try {
      state_.running = running;
      door_.check_quota(sender, quota, {.live_jobs = live, .stored_bytes = 6}, job, state_);
    } catch (const RetryLater& later) {
      EXPECT_EQ(later.code(), ErrorCode::too_many_jobs);
      return later.seconds();
    }
    return 0;
  }

  QueueState state_;
  Admission door_{100};

 private:
  void add(const std::string& owner) {
    owners_.insert(owner);
    state_.counts.owners = static_cast<std::int64_t>(owners_.size());
  }

  std::set<std::string> owners_;
};

TEST_F(Quotas, LetInWhoHasFewerJobs) {
  EXPECT_EQ(told("one", 1, {}), 0);
  EXPECT_EQ(told("one", 7, {}, {}), 0) << "without a quota";
}

TEST_F(Quotas, TellWhenTheFirstOfHisJobsEnds) {
  runs("his");
  waits("his");
  EXPECT_NEAR(told("one", 2, {{"his", 4}}), 6, 1);
  EXPECT_NEAR(told("two", 2, {{"his", 4}}), 16, 1) << "the next place is the next job's";
}

TEST_F(Quotas, ReckonWithTheTurnsOfOthers) {
  runs("his");
  waits("his");
  waits("another's");
  EXPECT_NEAR(told("one", 2, {{"his", 4}}), 6, 1);
  EXPECT_NEAR(told("two", 2, {{"his", 4}}), 26, 1) << "another's job runs in between";
}

TEST_F(Quotas, ReckonWithTheJobThatRunsBeforeHis) {
  runs("another's");
  waits("his");
  waits("his");
  EXPECT_GE(told("one", 2, {{"another's", 4}}), 16) << "6 until his begins, 10 until it ends";
}

TEST_F(Quotas, AreHisAlone) {
  runs("his");
  waits("his");
  EXPECT_GT(told("one", 2, {{"his", 4}}), 0);
  store::JobRecord job;
  job.owner = "another's";
  state_.running = {{"his", 4}};
  EXPECT_NO_THROW(door_.check_quota("one", kTwoJobs, {.live_jobs = 1}, job, state_));
}

TEST_F(Quotas, CountBytesOfTheJobThatComes) {
  EXPECT_EQ(told("one", 0, {}, {.max_bytes = 11}), 0);
  EXPECT_THROW(told("one", 0, {}, {.max_bytes = 10}), Error);
}

}  // namespace
}  // namespace unwrapd::server::jobs
