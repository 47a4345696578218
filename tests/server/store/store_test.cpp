// The store: what is committed is there after the file is opened again, and a job's state changes
// only from the state that its owner knows.
#include "server/store/job_store.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "core/base/error.hpp"
#include "server/base/files.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/store/sweeper.hpp"
#include "tests/server/take_job.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::store {
namespace {

using api::JobState;

JobRecord some_job(const std::string& id) {
  JobRecord job;
  job.id = id;
  job.created_ms = 1000;
  job.options = {{"method", "arap"}};
  job.notes = {"lambda has no effect"};
  job.input = {.sha256 = "ab", .bytes = 7, .buffers = {{"a b.bin", "buffer_0"}}};
  job.trace = "0af7";
  job.name = "St\u00fchle";
  return job;
}

class Store : public testing::Test {
 protected:
  void reopen() {
    store_.reset();
    store_ = std::make_unique<JobStore>(database_);
  }
  JobOutcome succeeded(std::int64_t finished_ms = 2000) const {
    return {.state = JobState::succeeded,
            .result_format = "glb",
            .problem = {},
            .last_event = 42,
            .finished_ms = finished_ms};
  }

  TempDir dir_;
  const database::DatabaseAddress database_ = database_in(dir_.path());
  std::unique_ptr<JobStore> store_ = std::make_unique<JobStore>(database_);
};

TEST_F(Store, KeepsEveryFieldOverAReopening) {
  const std::int64_t seq = store_->insert(some_job("j_1")).seq;
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
  EXPECT_EQ(job->trace, some_job("j_1").trace);
  EXPECT_EQ(job->name, some_job("j_1").name);
  EXPECT_TRUE(job->problem.is_null());
}

TEST_F(Store, FindsNothingThatWasNotInserted) { EXPECT_FALSE(store_->find("j_none")); }

TEST_F(Store, SpendsATicketOnceAndRemembersItBeyondItsJob) {
  const SpentTicket ticket{.id = "0af7", .until_ms = 5000};
  EXPECT_FALSE(store_->is_spent("0af7"));
  using enum Insertion::Outcome;
  const auto insert = [&](const char* id, const SpentTicket& with, std::int64_t now_ms) {
    return store_->insert(some_job(id), {}, with, now_ms).outcome;
  };
  ASSERT_EQ(insert("j_1", ticket, 1000), added);
  EXPECT_EQ(insert("j_2", ticket, 1000), ticket_spent);
  EXPECT_FALSE(store_->find("j_2")) << "neither or both";
  store_->remove("j_1");
  reopen();
  EXPECT_TRUE(store_->is_spent("0af7"));
  constexpr std::int64_t kDays = 24 * 3'600'000;
  ASSERT_EQ(insert("j_3", {.id = "0af8", .until_ms = 9000}, 6000), added);
  EXPECT_TRUE(store_->is_spent("0af7")) << "a day longer, as clocks may be set back";
  ASSERT_EQ(insert("j_4", {.id = "0af9", .until_ms = 2 * kDays}, 2 * kDays), added);
  EXPECT_FALSE(store_->is_spent("0af7"));
}

TEST_F(Store, TakesTheOldestFirstAndCountsTheAttempt) {
  store_->insert(some_job("j_1"));
  store_->insert(some_job("j_2"));
  EXPECT_EQ(store_->take("")->id, "j_1");
  const std::optional<JobRecord> second = store_->take("");
  EXPECT_EQ(second->id, "j_2");
  EXPECT_EQ(second->attempt, 1);
  EXPECT_EQ(second->state, JobState::running);
  EXPECT_FALSE(store_->take(""));
}

TEST_F(Store, TakesTheMostUrgentOfAnOwnersOwnJobs) {
  store_->insert(some_job("j_1"));
  JobRecord urgent = some_job("j_2");
  urgent.urgency = 1;
  store_->insert(urgent);
  JobRecord other = some_job("j_3");
  other.owner = "k_b";
  other.urgency = 0;
  store_->insert(other);
  EXPECT_EQ(store_->take("")->id, "j_2");
  EXPECT_EQ(store_->take("")->id, "j_1");
  EXPECT_FALSE(store_->take(""));
  EXPECT_EQ(store_->take("k_b")->id, "j_3");
}

TEST_F(Store, ARequestsNameIsItsOwnersAlone) {
  JobRecord job = some_job("j_1");
  job.request_key = "order 7";
  job.owner = "k_a";
  store_->insert(job);
  EXPECT_EQ(store_->find_request("k_a", "order 7")->id, "j_1");
  EXPECT_FALSE(store_->find_request("k_b", "order 7"));
  job.id = "j_2";
  EXPECT_EQ(store_->insert(job).outcome, Insertion::Outcome::known);
  EXPECT_FALSE(store_->find("j_2"));
  job.owner = "k_b";
  EXPECT_EQ(store_->insert(job).outcome, Insertion::Outcome::added);
}

TEST_F(Store, AnEqualQuestionIsFoundWhileItsAnswerIsKept) {
  JobRecord job = some_job("j_1");
  job.content_key = "c";
  store_->insert(job);
  EXPECT_FALSE(store_->find_same("", "c"));
  store_->finish(*store_->take(""), succeeded());
  EXPECT_EQ(store_->find_same("", "c")->id, "j_1");
  EXPECT_FALSE(store_->find_same("k_a", "c"));
  store_->set_expired("j_1");
  EXPECT_FALSE(store_->find_same("", "c"));
}

TEST_F(Store, ListsTheNewestFirstAndGoesOnAfterTheLastSeen) {
  for (const char* id : {"j_1", "j_2", "j_3"}) store_->insert(some_job(id));
  JobRecord other = some_job("j_4");
  other.owner = "k_a";
  store_->insert(other);
  const std::vector<JobRecord> first = store_->list({.owner = "", .state = {}, .limit = 2});
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first[0].id, "j_3");
  const std::vector<JobRecord> rest =
      store_->list({.owner = "", .state = {}, .before_seq = first[1].seq, .limit = 2});
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0].id, "j_1");
  EXPECT_EQ(store_->list({.owner = {}, .state = {}}).size(), 4U);
  EXPECT_EQ(store_->list({.owner = {}, .state = JobState::running}).size(), 0U);
}

TEST_F(Store, CountsWhatAnOwnerHas) {
  JobRecord job = some_job("j_1");
  job.stored_bytes = 7;
  store_->insert(job);
  EXPECT_EQ(store_->usage("").live_jobs, 1);
  EXPECT_EQ(store_->usage("").stored_bytes, 7);
  JobOutcome outcome = succeeded();
  outcome.stored_bytes = 50;
  store_->finish(*store_->take(""), outcome);
  EXPECT_EQ(store_->usage("").live_jobs, 0);
  EXPECT_EQ(store_->usage("").stored_bytes, 50);
  store_->set_expired("j_1");
  EXPECT_EQ(store_->usage("").stored_bytes, 0);
  EXPECT_EQ(store_->usage("k_a").live_jobs, 0);
}

TEST_F(Store, ALateWorkerCannotEndAnotherAttempt) {
  store_->insert(some_job("j_1"));
  const JobRecord first = *store_->take("");
  EXPECT_TRUE(store_->requeue(first, true));
  EXPECT_FALSE(store_->requeue(first, true));
  const JobRecord second = *store_->take("");
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
  store_->take("");
  JobOutcome outcome = succeeded();
  outcome.state = JobState::cancelled;
  EXPECT_FALSE(store_->finish(queued, outcome));
  EXPECT_EQ(store_->find("j_1")->state, JobState::running);
}

TEST_F(Store, RemembersARequestToCancelOverAReopening) {
  store_->insert(some_job("j_1"));
  store_->take("");
  store_->request_cancel("j_1");
  reopen();
  EXPECT_TRUE(store_->find("j_1")->cancel_requested);
}

TEST_F(Store, RefusesTablesOfAnotherSchema) {
  store_.reset();
  const std::shared_ptr<database::Database> newer = database_.open();
  newer->transact([&] { newer->set_version(99); });
  EXPECT_THROW(JobStore{database_}, Error);
}

TEST(AFileThatIsNoDatabase, IsRefused) {
  const TempDir dir;
  const std::filesystem::path path = dir.path() / "jobs.sqlite";
  write_file(path, std::string(5000, 'x'));
  EXPECT_THROW(JobStore{path}, Error);
}

TEST_F(Store, FilesExpireFirstAndTheJobAfterAsLongAgain) {
  blobs::BlobStore blobs(dir_.path());
  store_->insert(some_job("j_1"));
  blobs.begin_upload("j_1");
  blobs.keep_upload("j_1", "j_1");
  store_->finish(*store_->take(""), succeeded(1000));
  const auto file = blobs.path("j_1", blobs::kReportFile);
  blobs.write_unsealed("j_1", 1, blobs::kReportFile, "{}");

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
  blobs::BlobStore blobs(dir_.path());
  for (const char* job : {"j_known", "j_orphan"}) {
    blobs.begin_upload(job);
    blobs.keep_upload(job, job);
    blobs.write_unsealed(job, 1, blobs::kDocumentFile, "v");
  }
  blobs.begin_upload("j_upload");
  const auto part = blobs.path("j_known", "result.glb.part");
  File::create(part).append("half");
  const blobs::Swept swept = blobs.sweep(
      [](const std::string& job) {
        return job == "j_known" ? blobs::FolderFate::kept : blobs::FolderFate::gone;
      },
      0);
  EXPECT_EQ(swept.removed, 1);
  EXPECT_FALSE(std::filesystem::exists(part));
  EXPECT_TRUE(std::filesystem::exists(blobs.path("j_known", blobs::kDocumentFile)));
  EXPECT_FALSE(std::filesystem::exists(blobs.path("j_orphan", "")));
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "incoming"));
}

TEST_F(Store, TheEndOfAJobIsTellableBeforeItIsTold) {
  store_->insert(some_job("j_1"));
  blobs::BlobStore blobs(dir_.path());
  blobs.begin_upload("j_1");
  blobs.keep_upload("j_1", "j_1");
  jobs::EventFeed events;
  const Log log(LogLevel::off);
  jobs::JobQueue queue(*store_, blobs, events, log, {});
  queue.recover(false);
  const std::shared_ptr<jobs::RunningJob> job = take_job(queue);
  int calls = 0;
  queue.finish(*job, succeeded(), [&] {
    ++calls;
    EXPECT_EQ(store_->find("j_1")->state, JobState::succeeded);
    EXPECT_FALSE(job->feed->read(0).end) << "nobody knows yet";
  });
  EXPECT_EQ(calls, 1);
  EXPECT_TRUE(job->feed->read(0).end);
}

}  // namespace
}  // namespace unwrapd::server::store
