// A store that goes away in the middle of a change, which has come about or not: what the queue
// does about each. The database is one of SQLite that says so when it is told to.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <utility>

#include "server/base/errors.hpp"
#include "server/database/sqlite_database.hpp"
#include "server/jobs/job_queue.hpp"
#include "tests/server/take_job.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::jobs {
namespace {

using api::JobState;

/// What becomes of the next change.
enum class Fate { pass, made_then_away, made_unheard, lost_in_doubt, away };

class GoneDatabase final : public database::Database {
 public:
  GoneDatabase(const std::filesystem::path& file, Fate& next) : file_(file), next_(next) {}

  void run(const std::string& sql) override { file_.run(sql); }
  [[nodiscard]] std::unique_ptr<database::Cursor> prepare(std::string_view sql) const override {
    if (std::exchange(is_away_, false)) go_away(false);
    return file_.prepare(sql);
  }
  [[nodiscard]] int changes() const override { return file_.changes(); }
  [[nodiscard]] const database::Dialect& dialect() const override { return file_.dialect(); }
  [[nodiscard]] std::int64_t version() const override { return file_.version(); }
  [[nodiscard]] std::string step_to(std::int64_t version) const override {
    return file_.step_to(version);
  }
  void set_version(std::int64_t version) override { file_.set_version(version); }
  void check(bool indices) const override { file_.check(indices); }
  [[nodiscard]] bool was_away() override { return std::exchange(was_away_, false); }

 private:
  void apply_all(database::Extent /*extent*/, const std::function<void()>& make) override {
    const Fate fate = std::exchange(next_, Fate::pass);
    if (fate != Fate::lost_in_doubt && fate != Fate::away) file_.transact(make);
    is_away_ = fate == Fate::made_then_away;
    if (fate != Fate::pass && !is_away_) go_away(fate != Fate::away);
  }
  [[noreturn]] void go_away(bool in_doubt) const {
    was_away_ = true;
    throw StoreAway(StorePart::database, "gone", in_doubt);
  }

  database::SqliteDatabase file_;
  Fate& next_;
  mutable bool is_away_ = false;  // for the next statement
  mutable bool was_away_ = false;
};

class Mending : public testing::Test {
 protected:
  Mending() { queue_.recover(false); }

  void submit(const std::string& id) {
    blobs_.begin_upload(id);
    Submission submission;
    submission.job.id = id;
    submission.job.options = {{"method", "arap"}};
    submission.upload = id;
    queue_.submit(std::move(submission));
  }
  void submit_as(Fate fate, const std::string& id) {
    next_ = fate;
    EXPECT_THROW(submit(id), StoreAway);
  }
  [[nodiscard]] bool has_files(const std::string& id) const {
    return std::filesystem::exists(blobs_.path(id, ""));
  }
  static store::JobOutcome succeeded() { return {.result_format = "glb", .problem = {}}; }

  TempDir dir_;
  Fate next_ = Fate::pass;
  store::JobStore store_{database::DatabaseAddress([this]() -> std::shared_ptr<database::Database> {
    return std::make_unique<GoneDatabase>(dir_.path() / "jobs.sqlite", next_);
  })};
  blobs::BlobStore blobs_{dir_.path()};
  EventFeed events_;
  const Log log_{LogLevel::off};
  JobQueue queue_{store_, blobs_, events_, log_, {}};
};

TEST_F(Mending, AJobThatWasStoredUnheardIsRun) {
  submit_as(Fate::made_unheard, "j_1");
  submit("j_2");
  EXPECT_TRUE(has_files("j_1"));
  queue_.mend();
  EXPECT_EQ(take_job(queue_)->record.id, "j_1");
  EXPECT_EQ(take_job(queue_)->record.id, "j_2");
}

TEST_F(Mending, AJobThatWasStoredWhenTheStoreGoesAwayKeepsItsFiles) {
  next_ = Fate::made_then_away;
  submit("j_1");
  EXPECT_TRUE(has_files("j_1"));
  EXPECT_EQ(take_job(queue_)->record.id, "j_1");
}

TEST_F(Mending, AJobThatWasNotStoredLeavesNoFiles) {
  submit_as(Fate::away, "j_1");
  EXPECT_FALSE(has_files("j_1")) << "as is known at once";
  submit_as(Fate::lost_in_doubt, "j_2");
  EXPECT_TRUE(has_files("j_2"));
  queue_.mend();
  EXPECT_FALSE(has_files("j_2"));
}

TEST_F(Mending, AJobThatWasTakenUnheardIsTakenAgain) {
  submit("j_1");
  next_ = Fate::made_unheard;
  EXPECT_THROW(take_job(queue_), StoreAway);
  EXPECT_EQ(store_.find("j_1")->state, JobState::running);
  queue_.mend();
  const std::shared_ptr<RunningJob> job = take_job(queue_);
  EXPECT_EQ(job->record.attempt, 2);
  EXPECT_EQ(job->record.crashes, 0) << "no server died";
}

TEST_F(Mending, TheEndOfAJobWaitsForTheStoreAndComesOnce) {
  for (const Fate fate : {Fate::away, Fate::lost_in_doubt, Fate::made_unheard}) {
    const std::string id = "j_" + std::to_string(static_cast<int>(fate));
    submit(id);
    const std::shared_ptr<RunningJob> job = take_job(queue_);
    int stored = 0;
    next_ = fate;
    queue_.finish(*job, succeeded(), [&] { ++stored; });
    EXPECT_EQ(stored, 1);
    EXPECT_EQ(store_.find(id)->state, JobState::succeeded);
    EXPECT_TRUE(job->feed->read(0).end);
    queue_.mend();
    EXPECT_TRUE(has_files(id));
  }
}

TEST_F(Mending, ACancelThatWasStoredUnheardIsToldAndCounted) {
  submit("j_1");
  submit("j_2");
  const std::shared_ptr<JobFeed> feed = events_.find("j_1");
  next_ = Fate::made_unheard;
  EXPECT_THROW(queue_.cancel_or_remove("j_1"), StoreAway);
  EXPECT_FALSE(feed->read(0).end);
  queue_.mend();
  EXPECT_TRUE(feed->read(0).end);
  EXPECT_FALSE(has_files("j_1"));
  EXPECT_EQ(take_job(queue_)->record.id, "j_2");
  queue_.close();
  EXPECT_EQ(take_job(queue_), nullptr);
}

}  // namespace
}  // namespace unwrapd::server::jobs
