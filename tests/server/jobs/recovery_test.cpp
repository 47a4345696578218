// What becomes of jobs that nobody works on any longer: their server ended, or could not stop them,
// their owner cancelled them meanwhile, or there are too many.
#include <gtest/gtest.h>

#include <memory>

#include "server/base/clock.hpp"
#include "server/jobs/job_queue.hpp"
#include "tests/server/take_job.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::jobs {
namespace {

using api::JobState;

store::JobRecord some_job(const std::string& id) {
  store::JobRecord job;
  job.id = id;
  job.options = {{"method", "arap"}};
  return job;
}

class Recovery : public testing::Test {
 protected:
  static constexpr std::int64_t kLeaseMs = 5000;

  static store::JobOutcome succeeded(std::int64_t finished_ms = 2000) {
    return {.state = JobState::succeeded,
            .result_format = "glb",
            .problem = {},
            .finished_ms = finished_ms};
  }

  TempDir dir_;
  std::unique_ptr<store::JobStore> store_ =
      std::make_unique<store::JobStore>(database_in(dir_.path()));
  blobs::BlobStore blobs_{dir_.path()};
  EventFeed events_;
  const Log log_{LogLevel::off};
};

TEST_F(Recovery, TheLongestWaitIsThatOfTheFirstJobThatWaits) {
  JobQueue queue(*store_, blobs_, events_, log_, {});
  EXPECT_EQ(queue.waiting_seconds(), 0);
  for (const int waits_s : {90, 30}) {
    store::JobRecord job = some_job("j_" + std::to_string(waits_s));
    job.created_ms = now_ms() - 1000 * waits_s;
    store_->insert(job);
  }
  EXPECT_GE(queue.waiting_seconds(), 90);
  take_job(queue);
  EXPECT_GE(queue.waiting_seconds(), 30);
  EXPECT_LT(queue.waiting_seconds(), 90);
  take_job(queue);
  EXPECT_EQ(queue.waiting_seconds(), 0);
}

TEST_F(Recovery, AJobThatDoesNotStopIsLeftToTheNextStartAndSuspected) {
  store_->insert(some_job("j_1"));
  std::filesystem::create_directories(blobs_.path("j_1", "uv.bin").parent_path());
  JobQueue queue(*store_, blobs_, events_, log_, {.stop = std::chrono::milliseconds(1)});
  queue.recover(false);
  const std::shared_ptr<RunningJob> job = take_job(queue);
  EXPECT_FALSE(queue.drain(std::chrono::seconds(0)));
  EXPECT_TRUE(job->stop.stop_requested());
  EXPECT_EQ(store_->find("j_1")->state, JobState::queued);
  queue.finish(*job, succeeded());  // too late
  EXPECT_EQ(store_->find("j_1")->state, JobState::queued);
  EXPECT_EQ(store_->find("j_1")->crashes, 1) << "it goes on in a process of its own";
}

TEST_F(Recovery, AJobThatDoesNotStopAndIsCancelledIsNotRunAgain) {
  store_->insert(some_job("j_1"));
  JobQueue queue(*store_, blobs_, events_, log_, {.stop = std::chrono::milliseconds(1)});
  queue.recover(false);
  const std::shared_ptr<RunningJob> job = take_job(queue);
  EXPECT_TRUE(queue.cancel_or_remove("j_1"));
  EXPECT_FALSE(queue.drain(std::chrono::seconds(0)));
  EXPECT_EQ(store_->find("j_1")->state, JobState::cancelled);
}

TEST_F(Recovery, AJobThatStopsForTheEndAndIsCancelledMeanwhileIsNotRunAgain) {
  store_->insert(some_job("j_1"));
  JobQueue queue(*store_, blobs_, events_, log_, {});
  queue.recover(false);
  const std::shared_ptr<RunningJob> job = take_job(queue);
  job->request_stop(StopCause::draining);
  EXPECT_TRUE(queue.cancel_or_remove("j_1"));
  queue.finish(*job, store::ended(JobState::cancelled, Error(ErrorCode::cancelled, ""), "j_1"));
  EXPECT_EQ(store_->find("j_1")->state, JobState::cancelled);
}

TEST_F(Recovery, AWaitingJobThatWasToBeCancelledIsNotRunAgain) {
  store_->insert(some_job("j_1"));
  store_->insert(some_job("j_2"));
  store_->request_cancel("j_1");
  JobQueue queue(*store_, blobs_, events_, log_, {});
  queue.recover(false);
  EXPECT_EQ(store_->find("j_1")->state, JobState::cancelled);
  EXPECT_EQ(take_job(queue)->record.id, "j_2");
}

TEST_F(Recovery, AJobThatNeverStopsIsGivenUpWhereItCannotBeTriedApart) {
  store_->insert(some_job("j_1"));
  for (int start = 1; start <= 3; ++start) {
    JobQueue queue(*store_, blobs_, events_, log_, {.stop = std::chrono::milliseconds(1)});
    queue.recover(false);
    const std::shared_ptr<RunningJob> job = take_job(queue);
    ASSERT_NE(job, nullptr) << start;
    EXPECT_FALSE(queue.drain(std::chrono::seconds(0)));
  }
  EXPECT_EQ(store_->find("j_1")->problem.at("code"), "poison");
}

TEST_F(Recovery, AJobAtWorkAtTenDeathsIsGivenUpThoughItWasTriedApart) {
  store_->insert(some_job("j_1"));
  for (int death = 1; death <= 10; ++death) {
    ASSERT_EQ(store_->find("j_1")->state, JobState::queued) << death;
    store_->take("");
    EventFeed events;
    JobQueue(*store_, blobs_, events, log_, {}).recover(true);
  }
  EXPECT_EQ(store_->find("j_1")->state, JobState::failed);
  EXPECT_EQ(store_->find("j_1")->problem.at("code"), "poison");
}

/// Ended jobs, which came in the order of their ids, and a queue that keeps two of them.
class BoundedStore : public Recovery {
 protected:
  void add_ended(const std::string& id, const std::string& owner, bool expired = false) {
    store::JobRecord job = some_job(id);
    job.owner = owner;
    store_->insert(job);
    store_->finish(*store_->take(owner), succeeded(++ended_));
    if (expired) store_->set_expired(id);
    make_directories(dir_.path() / "blobs" / id);
  }
  void submit(JobQueue& queue, const std::string& id) {
    blobs_.begin_upload(id);
    Submission submission;
    submission.job = some_job(id);
    submission.upload = id;
    queue.submit(std::move(submission));
  }
  [[nodiscard]] std::string ids() {
    std::string all;
    for (const store::JobRecord& job : store_->list({.owner = {}, .state = {}})) all += job.id;
    return all;
  }

  std::int64_t ended_ = 0;
};

TEST_F(BoundedStore, GivesUpExpiredJobsThenThoseOfTheOwnerWithTheMost) {
  add_ended("j_1", "modest");
  for (const char* id : {"j_2", "j_3"}) add_ended(id, "greedy");
  add_ended("j_4", "other", true);
  JobQueue queue(*store_, blobs_, events_, log_, {.max_stored = 2});
  queue.recover(false);
  for (const char* id : {"j_5", "j_6", "j_7"}) submit(queue, id);
  EXPECT_EQ(ids(), "j_7j_6j_5j_3j_1") << "j_4 and j_2 are given up, and nothing that waits";
  EXPECT_FALSE(std::filesystem::exists(dir_.path() / "blobs" / "j_2"));
  EXPECT_TRUE(std::filesystem::exists(dir_.path() / "blobs" / "j_1"));
  const std::shared_ptr<RunningJob> job = take_job(queue);
  queue.finish(*job, succeeded(++ended_));
  queue.renew_leases();
  EXPECT_EQ(ids(), "j_7j_6j_3j_1") << "of the owner with three jobs";
}

TEST_F(BoundedStore, MeetsABoundThatWasLowered) {
  for (const char* id : {"j_1", "j_2", "j_3"}) add_ended(id, "");
  JobQueue queue(*store_, blobs_, events_, log_, {.max_stored = 2});
  queue.recover(false);
  queue.renew_leases();
  EXPECT_EQ(ids(), "j_3j_2");
}

}  // namespace
}  // namespace unwrapd::server::jobs
