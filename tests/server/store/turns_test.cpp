// Whose turn it is, and which node a job belongs to: decided by rows, so that all nodes agree.
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <set>
#include <string>

#include "server/store/job_store.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::store {
namespace {

using api::JobState;

constexpr std::int64_t kMeanMs = 1000;

class Turns : public testing::Test {
 protected:
  void add(const std::string& owner) {
    JobRecord job;
    job.id = "j_" + std::to_string(++count_);
    job.owner = owner;
    job.options = job.notes = api::Json::array();
    ASSERT_GT(store_->insert(job).seq, 0);
  }
  JobRecord start(const std::string& owner) { return *store_->take(owner); }
  void end(const JobRecord& job, std::int64_t ran_ms) {
    ASSERT_TRUE(store_->finish(
        job, {.result_format = "glb", .problem = {}, .finished_ms = ++count_, .ran_ms = ran_ms}));
  }
  std::string next() { return store_->next_owner(kMeanMs).value_or("nobody"); }

  TempDir dir_;
  const database::DatabaseAddress database_ = database_in(dir_.path());
  std::unique_ptr<JobStore> store_ = std::make_unique<JobStore>(database_);
  std::int64_t count_ = 0;
};

TEST_F(Turns, AnEndIsOfOneRowThoughItsNameIsUsedAgain) {
  add("owner");
  const JobRecord before = start("owner");
  store_->remove(before.id);
  count_ = 0;
  add("owner");
  const JobRecord now = start("owner");
  ASSERT_EQ(now.id, before.id);
  ASSERT_EQ(now.attempt, before.attempt);
  EXPECT_FALSE(store_->beat(before));
  EXPECT_FALSE(store_->requeue(before, false, 0));
  EXPECT_FALSE(store_->finish(
      before, {.result_format = "glb", .problem = {}, .finished_ms = 1, .ran_ms = 1}));
  EXPECT_TRUE(store_->beat(now));
}

TEST_F(Turns, ManyJobsOfOneOwnerDoNotKeepAnotherWaiting) {
  for (int k = 0; k < 50; ++k) add("greedy");
  std::string order;
  for (int k = 0; k < 5; ++k) {
    if (k == 2) {
      add("modest");
      add("modest");
    }
    const std::string owner = next();
    order += owner.front();
    end(start(owner), 1000);
  }
  EXPECT_EQ(order, "gggmg") << "one that comes later starts level, and then takes turns";
  EXPECT_EQ(store_->counts().waiting, 47);
  EXPECT_EQ(store_->counts().owners, 2);
}

TEST_F(Turns, LongJobsCountForMoreThanShortOnes) {
  for (int k = 0; k < 60; ++k) {
    add("long");
    add("short");
  }
  double seconds[2] = {};
  for (int k = 0; k < 60; ++k) {
    const std::string owner = next();
    const int took = owner == "long" ? 5 : 1;
    seconds[owner == "long"] += took;
    end(start(owner), took * 1000);
  }
  EXPECT_NEAR(seconds[0], seconds[1], 5);
}

TEST_F(Turns, RunningJobsCountBeforeTheyEnd) {
  for (int k = 0; k < 3; ++k) {
    add("a");
    add("b");
  }
  start(next());
  EXPECT_EQ(next(), "b");
  start(next());
  EXPECT_EQ(store_->counts().waiting, 4);
  EXPECT_EQ(store_->counts().running, 2);
}

TEST_F(Turns, AreLevelAgainOnceNobodyHasJobs) {
  add("served");
  end(start("served"), 9000);
  store_->level_shares();
  add("served");
  add("zealous");
  EXPECT_EQ(next(), "served") << "by name, as neither was served";
}

TEST_F(Turns, AreRememberedOverAStart) {
  for (const char* owner : {"a", "a", "b"}) add(owner);
  end(start("a"), 5000);
  store_.reset();
  store_ = std::make_unique<JobStore>(database_);
  EXPECT_EQ(next(), "b");
  EXPECT_EQ(store_->last_lengths(9), std::vector<double>{5.0});
}

/// Whatever becomes of jobs, the counts are those of the rows.
TEST_F(Turns, CountWhatTheRowsSay) {
  std::mt19937 random(7);
  const std::set<std::string> owners = {"", "k_a", "k_b"};
  for (int step = 0; step < 200; ++step) {
    const std::string& owner = *std::next(owners.begin(), random() % 3);
    switch (random() % 5) {
      case 0:
      case 1:
        add(owner);
        break;
      case 2:
        static_cast<void>(store_->take(owner));
        break;
      case 3:
        for (const JobRecord& job : store_->running())
          if (random() % 2 == 0 ? store_->requeue(job, true) : false) break;
        break;
      default:
        if (const auto all = store_->unfinished(); !all.empty()) {
          const JobRecord& job = all[random() % all.size()];
          random() % 2 == 0 ? end(job, 10) : store_->remove(job.id);
        }
    }
    const QueueCounts counts = store_->counts();
    std::int64_t waiting = 0, running = 0;
    std::set<std::string> with_jobs;
    for (const JobRecord& job : store_->unfinished()) {
      ++(job.state == JobState::queued ? waiting : running);
      with_jobs.insert(job.owner);
    }
    ASSERT_EQ(counts.waiting, waiting) << step;
    ASSERT_EQ(counts.running, running) << step;
    ASSERT_EQ(counts.owners, with_jobs.size()) << step;
  }
}

TEST_F(Turns, DamagedCountsAreMendedAtTheStart) {
  for (const char* owner : {"a", "b", "b"}) add(owner);
  start("b");
  store_.reset();
  const std::shared_ptr<database::Database> other = database_.open();
  other->transact([&] { other->run("UPDATE shares SET waiting = 7, running = 0"); });
  store_ = std::make_unique<JobStore>(database_);
  EXPECT_EQ(store_->counts().waiting, 2);
  EXPECT_EQ(store_->counts().running, 1);
}

TEST_F(Turns, AnInsertionBeyondWhatItsOwnerMayHaveAddsNothing) {
  using enum Insertion::Outcome;
  add("");
  JobRecord job;
  job.id = "j_more";
  job.options = job.notes = api::Json::array();
  job.stored_bytes = 10;
  EXPECT_EQ(store_->insert(job, {.live_jobs = 1}).outcome, too_many_jobs);
  EXPECT_EQ(store_->insert(job, {.stored_bytes = 9}).outcome, too_many_bytes);
  EXPECT_FALSE(store_->find("j_more"));
  EXPECT_EQ(store_->counts().waiting, 1);
  EXPECT_EQ(store_->insert(job, {.live_jobs = 2, .stored_bytes = 10}).outcome, added);
}

TEST_F(Turns, ABeatIsThatOfTheAttemptThatRuns) {
  add("");
  const JobRecord first = start("");
  EXPECT_TRUE(store_->beat(first));
  const JobRecord shown = store_->running().front();
  EXPECT_EQ(shown.beat, 1);
  EXPECT_TRUE(store_->beat(first));
  EXPECT_FALSE(store_->requeue(shown, true)) << "a sign of life came meanwhile";
  EXPECT_TRUE(store_->requeue(store_->running().front(), true));
  EXPECT_FALSE(store_->beat(first));
  start("");
  EXPECT_FALSE(store_->beat(first)) << "another attempt";
}

}  // namespace
}  // namespace unwrapd::server::store
