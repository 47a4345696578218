// The store: what is committed is there after the file is opened again, and a job's state changes
// only from the state that its owner knows.
#include "server/job_store.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "core/error.hpp"
#include "server/files.hpp"
#include "server/sweeper.hpp"
#include "temp_dir.hpp"

namespace unwrapd::server {
namespace {

using api::JobState;

JobRecord some_job(const std::string& id) {
  JobRecord job;
  job.id = id;
  job.created_ms = 1000;
  job.options = {{"method", "arap"}};
  job.notes = {"lambda has no effect"};
  job.input = {.sha256 = "ab", .bytes = 7, .buffers = {{"a b.bin", "buffer_0"}}};
  return job;
}

class Store : public testing::Test {
 protected:
  std::filesystem::path path() const { return dir_.path() / "jobs.sqlite"; }
  void reopen() {
    store_.reset();
    store_ = std::make_unique<JobStore>(path());
  }
  JobOutcome succeeded(std::int64_t finished_ms = 2000) const {
    return {.state = JobState::succeeded,
            .result_format = "glb",
            .problem = {},
            .last_event = 42,
            .finished_ms = finished_ms};
  }

  TempDir dir_;
  std::unique_ptr<JobStore> store_ = std::make_unique<JobStore>(path());
};

TEST_F(Store, KeepsEveryFieldOverAReopening) {
  const std::int64_t seq = store_->insert(some_job("j_1"));
  reopen();
  const std::optional<JobRecord> job = store_->find("j_1");
  ASSERT_TRUE(job);
  EXPECT_EQ(job->seq, seq);
  EXPECT_EQ(job->state, JobState::queued);
  EXPECT_EQ(job->created_ms, 1000);
  EXPECT_EQ(job->options, some_job("j_1").options);
  EXPECT_EQ(job->notes, some_job("j_1").notes);
  EXPECT_EQ(job->input.bytes, 7);
  ASSERT_EQ(job->input.buffers.size(), 1U);
  EXPECT_EQ(job->input.buffers[0].uri, "a b.bin");
  EXPECT_TRUE(job->problem.is_null());
}

TEST_F(Store, FindsNothingThatWasNotInserted) { EXPECT_FALSE(store_->find("j_none")); }

TEST_F(Store, TakesTheOldestFirstAndCountsTheAttempt) {
  store_->insert(some_job("j_1"));
  store_->insert(some_job("j_2"));
  EXPECT_EQ(store_->take_oldest()->id, "j_1");
  const std::optional<JobRecord> second = store_->take_oldest();
  EXPECT_EQ(second->id, "j_2");
  EXPECT_EQ(second->attempt, 1);
  EXPECT_EQ(second->state, JobState::running);
  EXPECT_FALSE(store_->take_oldest());
}

TEST_F(Store, ALateWorkerCannotEndAnotherAttempt) {
  store_->insert(some_job("j_1"));
  const JobRecord first = *store_->take_oldest();
  store_->requeue("j_1", true);
  const JobRecord second = *store_->take_oldest();
  EXPECT_FALSE(store_->finish(first, succeeded()));
  EXPECT_TRUE(store_->finish(second, succeeded()));
  EXPECT_FALSE(store_->finish(second, succeeded()));
  const JobRecord job = *store_->find("j_1");
  EXPECT_EQ(job.attempt, 2);
  EXPECT_EQ(job.crashes, 1);
  EXPECT_EQ(job.result_format, "glb");
  EXPECT_EQ(job.last_event, 42);
}

TEST_F(Store, AJobThatIsTakenIsNotCancelledAsQueued) {
  store_->insert(some_job("j_1"));
  const JobRecord queued = *store_->find("j_1");
  store_->take_oldest();
  JobOutcome outcome = succeeded();
  outcome.state = JobState::cancelled;
  EXPECT_FALSE(store_->finish(queued, outcome));
  EXPECT_EQ(store_->find("j_1")->state, JobState::running);
}

TEST_F(Store, RemembersARequestToCancelOverAReopening) {
  store_->insert(some_job("j_1"));
  store_->take_oldest();
  store_->request_cancel("j_1");
  reopen();
  EXPECT_TRUE(store_->find("j_1")->cancel_requested);
}

TEST_F(Store, RefusesAFileOfAnotherSchema) {
  store_.reset();
  Database(path()).run("PRAGMA user_version = 99");
  EXPECT_THROW(JobStore{path()}, Error);
}

TEST_F(Store, RefusesAFileThatIsNoDatabase) {
  store_.reset();
  std::filesystem::remove_all(dir_.path());
  std::filesystem::create_directories(dir_.path());
  write_file(path(), std::string(5000, 'x'));
  EXPECT_THROW(JobStore{path()}, Error);
}

TEST_F(Store, FilesExpireFirstAndTheJobAfterAsLongAgain) {
  BlobStore blobs(dir_.path());
  store_->insert(some_job("j_1"));
  blobs.begin_upload("j_1");
  blobs.keep_upload("j_1");
  store_->finish(*store_->take_oldest(), succeeded(1000));
  const auto file = blobs.path("j_1", kReportFile);
  blobs.write("j_1", kReportFile, "{}");

  sweep(*store_, blobs, 10'999, std::chrono::seconds(10));
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_FALSE(store_->find("j_1")->expired);
  sweep(*store_, blobs, 11'001, std::chrono::seconds(10));
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_TRUE(store_->find("j_1")->expired);
  sweep(*store_, blobs, 21'001, std::chrono::seconds(10));
  EXPECT_FALSE(store_->find("j_1"));
}

TEST_F(Store, WhatACrashLeavesBehindIsSwept) {
  BlobStore blobs(dir_.path());
  for (const char* job : {"j_known", "j_orphan"}) {
    blobs.begin_upload(job);
    blobs.keep_upload(job);
    blobs.write(job, kDocumentFile, "v");
  }
  blobs.begin_upload("j_upload");
  const auto part = blobs.path("j_known", "result.glb.part");
  File::create(part).append("half");
  blobs.sweep([](const std::string& job) { return job == "j_known"; });
  EXPECT_FALSE(std::filesystem::exists(part));
  EXPECT_TRUE(std::filesystem::exists(blobs.path("j_known", kDocumentFile)));
  EXPECT_FALSE(std::filesystem::exists(blobs.path("j_orphan", "")));
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "incoming"));
}

}  // namespace
}  // namespace unwrapd::server
