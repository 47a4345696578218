#include "server/jobs/lease_watch.hpp"

#include <gtest/gtest.h>

namespace unwrapd::server::jobs {
namespace {

using namespace std::chrono_literals;

store::JobRecord shown(const std::string& id, int attempt, std::int64_t beat) {
  store::JobRecord job;
  job.id = id;
  job.attempt = attempt;
  job.beat = beat;
  return job;
}

class Leases : public testing::Test {
 protected:
  std::size_t lapsed(LeaseWatch::Clock::duration at, const std::vector<store::JobRecord>& jobs) {
    return watch_.lapsed(jobs, start_ + at).size();
  }

  const LeaseWatch::Clock::time_point start_ = LeaseWatch::Clock::now();
  LeaseWatch watch_{10s};
};

TEST_F(Leases, EndWhenABeatHasNotRisenForTheirLength) {
  EXPECT_EQ(lapsed(0s, {shown("j", 1, 4)}), 0U) << "seen for the first time";
  EXPECT_EQ(lapsed(10s, {shown("j", 1, 4)}), 0U);
  EXPECT_EQ(lapsed(11s, {shown("j", 1, 4), shown("new", 1, 4)}), 1U);
}

TEST_F(Leases, GoOnWithEachBeatAndEachAttempt) {
  EXPECT_EQ(lapsed(0s, {shown("j", 1, 4)}), 0U);
  EXPECT_EQ(lapsed(9s, {shown("j", 1, 5)}), 0U);
  EXPECT_EQ(lapsed(18s, {shown("j", 2, 5)}), 0U);
  EXPECT_EQ(lapsed(27s, {shown("j", 2, 5)}), 0U);
  EXPECT_EQ(lapsed(29s, {shown("j", 2, 5)}), 1U);
}

TEST_F(Leases, BeginAnewAfterTheStoreWasAway) {
  EXPECT_EQ(lapsed(0s, {shown("j", 1, 4)}), 0U);
  watch_.forget();
  EXPECT_EQ(lapsed(30s, {shown("j", 1, 4)}), 0U);
  EXPECT_EQ(lapsed(41s, {shown("j", 1, 4)}), 1U);
}

TEST_F(Leases, OfAJobThatNoLongerRunsAreForgotten) {
  EXPECT_EQ(lapsed(0s, {shown("j", 1, 4)}), 0U);
  EXPECT_EQ(lapsed(5s, {}), 0U);
  EXPECT_EQ(lapsed(30s, {shown("j", 1, 4)}), 0U);
}

}  // namespace
}  // namespace unwrapd::server::jobs
