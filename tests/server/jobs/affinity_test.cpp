#include "server/jobs/affinity.hpp"

#include <gtest/gtest.h>

namespace unwrapd::server::jobs {
namespace {

using store::WaitingJob;

constexpr Affinity::Clock::time_point kFirstLook{};

WaitingJob known_nowhere(std::int64_t seq) { return {.seq = seq}; }
WaitingJob known_here(std::int64_t seq) { return {.seq = seq, .is_known_here = true}; }
WaitingJob known_elsewhere(std::int64_t seq) { return {.seq = seq, .is_known_elsewhere = true}; }

std::int64_t chosen(Affinity& affinity, const std::vector<WaitingJob>& jobs,
                    Affinity::Clock::time_point now = kFirstLook) {
  const auto job = affinity.choose(jobs, now);
  return job ? job->seq : 0;
}

TEST(Affinity, TakesTheFirstJobThatNoOtherNodeKnows) {
  Affinity affinity;
  EXPECT_EQ(chosen(affinity, {}), 0);
  EXPECT_EQ(chosen(affinity, {known_nowhere(1), known_here(2)}), 1);
  EXPECT_EQ(chosen(affinity, {known_elsewhere(1), known_nowhere(2), known_here(3)}), 2);
  EXPECT_EQ(chosen(affinity, {known_elsewhere(1), known_here(3), known_nowhere(4)}), 3);
  const WaitingJob both{.seq = 5, .is_known_here = true, .is_known_elsewhere = true};
  EXPECT_EQ(chosen(affinity, {known_elsewhere(1), both}), 5);
}

TEST(Affinity, LeavesAJobToTheOtherNodeForAWhileAndNoLonger) {
  Affinity affinity;
  const auto jobs = {known_elsewhere(1), known_elsewhere(2)};
  EXPECT_EQ(chosen(affinity, jobs), 0);
  EXPECT_EQ(chosen(affinity, jobs, kFirstLook + Affinity::kWait / 2), 0);
  EXPECT_EQ(chosen(affinity, jobs, kFirstLook + Affinity::kWait), 1);
  affinity.count(known_elsewhere(1));
  EXPECT_EQ(chosen(affinity, {known_elsewhere(2)}, kFirstLook + Affinity::kWait), 2);
  EXPECT_EQ(chosen(affinity, {known_elsewhere(3)}, kFirstLook + Affinity::kWait), 0) << "it is new";
}

/// Of a node that looks seldom, and always finds another job, too.
TEST(Affinity, LeavesNoJobToOthersTwice) {
  Affinity affinity;
  EXPECT_EQ(chosen(affinity, {known_elsewhere(1), known_nowhere(2)}), 2);
  const auto later = kFirstLook + std::chrono::hours(1);
  EXPECT_EQ(chosen(affinity, {known_elsewhere(1), known_nowhere(3)}, later), 1);
}

TEST(Affinity, CountsWhereMeshesCome) {
  Affinity affinity;
  affinity.count(known_nowhere(1));
  affinity.count(known_here(2));
  affinity.count(known_here(3));
  affinity.count(known_elsewhere(4));
  EXPECT_EQ(affinity.counts().hits, 2U);
  EXPECT_EQ(affinity.counts().misses, 1U);
}

}  // namespace
}  // namespace unwrapd::server::jobs
