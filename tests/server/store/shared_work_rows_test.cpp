// Work that several processes share, as rows: who makes which bundle, and for how long they last.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "server/store/job_store.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::store {
namespace {

class SharedWorkRows : public testing::Test {
 protected:
  JobRecord running(const std::string& owner = "") {
    JobRecord job;
    job.id = "j_" + std::to_string(++count_);
    job.owner = owner;
    job.options = job.notes = api::Json::array();
    EXPECT_GT(store_->insert(job).seq, 0);
    return *store_->take(owner);
  }
  void end(const JobRecord& job) {
    ASSERT_TRUE(store_->finish(job, {.result_format = "glb", .problem = {}, .finished_ms = 1}));
  }
  static StageOfJob stage(const JobRecord& job, const std::string& name = "segment") {
    return {.job = job.seq, .attempt = job.attempt, .stage = name};
  }
  /// The owner of the job to help with.
  std::string helped(const std::vector<std::int64_t>& passed_over = {}) {
    const auto job = store_->job_to_help(passed_over);
    return job ? job->owner : "nobody";
  }

  TempDir dir_;
  const database::DatabaseAddress database_ = database_in(dir_.path());
  std::unique_ptr<JobStore> store_ = std::make_unique<JobStore>(database_);
  int count_ = 0;
};

TEST_F(SharedWorkRows, EachBundleIsClaimedOnce) {
  const StageOfJob of = stage(running());
  EXPECT_FALSE(store_->claim_bundle(of, false)) << "the stage is not known";
  EXPECT_TRUE(store_->open_stage(of, 3));
  EXPECT_FALSE(store_->open_stage(of, 3)) << "it is known";
  EXPECT_EQ(store_->claim_bundle(of, false), 0);
  EXPECT_EQ(store_->claim_bundle(of, true), 2);
  EXPECT_EQ(store_->claim_bundle(of, true), 1);
  EXPECT_FALSE(store_->claim_bundle(of, false));
  EXPECT_FALSE(store_->claim_bundle(of, true));
}

TEST_F(SharedWorkRows, ABundleHasTheBytesThatWereKept) {
  const StageOfJob of = stage(running());
  std::string bytes(5000, '\0');
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<char>(k * 7);
  store_->keep_bundle(of, 1, bytes);
  EXPECT_FALSE(store_->bundle(of, 1)) << "of a stage that is not known";
  store_->open_stage(of, 3);
  store_->keep_bundle(of, 1, "unsound");
  store_->keep_bundle(of, 1, bytes);
  EXPECT_EQ(store_->bundle(of, 1), bytes);
  EXPECT_FALSE(store_->bundle(of, 0));
  EXPECT_FALSE(store_->bundle(stage(running()), 1)) << "of another job";
}

TEST_F(SharedWorkRows, ALaterAttemptBeginsAnewAndFindsWhatWasMade) {
  const JobRecord first = running();
  const StageOfJob before = stage(first);
  store_->open_stage(before, 2);
  EXPECT_EQ(store_->claim_bundle(before, false), 0);
  store_->keep_bundle(before, 0, "made");
  ASSERT_TRUE(store_->requeue(first, true));
  EXPECT_FALSE(store_->is_running(first.seq, first.attempt));
  const JobRecord second = *store_->take("");
  ASSERT_EQ(second.seq, first.seq);
  EXPECT_FALSE(store_->is_running(first.seq, first.attempt));
  EXPECT_TRUE(store_->is_running(second.seq, second.attempt));
  const StageOfJob now = stage(second);
  EXPECT_TRUE(store_->open_stage(now, 2));
  EXPECT_FALSE(store_->open_stage(before, 2)) << "a helper of the attempt before";
  EXPECT_FALSE(store_->claim_bundle(before, true));
  store_->keep_bundle(before, 0, "late");
  EXPECT_EQ(store_->claim_bundle(now, false), 0);
  EXPECT_EQ(store_->bundle(now, 0), "made");
}

TEST_F(SharedWorkRows, HelpGoesToTheOwnerWhoWasServedLeast) {
  EXPECT_EQ(helped(), "nobody");
  const JobRecord a = running("a"), b = running("b");
  EXPECT_EQ(helped(), "nobody") << "neither shares its work";
  store_->open_stage(stage(a), 2);
  store_->open_stage(stage(b), 2);
  EXPECT_EQ(helped(), "a");
  EXPECT_EQ(helped({a.seq}), "b");
  store_->charge("a", 1000);
  EXPECT_EQ(helped(), "b");
  store_->claim_bundle(stage(b), false);
  store_->claim_bundle(stage(b), true);
  EXPECT_EQ(helped(), "a") << "all bundles of the other were begun";
  store_->request_cancel(a.id);
  EXPECT_EQ(helped(), "nobody");
}

TEST_F(SharedWorkRows, TheyLastAsLongAsTheirJobRuns) {
  const JobRecord ended = running(), other = running();
  for (const JobRecord& job : {ended, other}) {
    store_->open_stage(stage(job), 2);
    store_->keep_bundle(stage(job), 0, "made");
  }
  store_->drop_ended_shared_work();
  EXPECT_TRUE(store_->bundle(stage(ended), 0));
  end(ended);
  store_->drop_ended_shared_work();
  EXPECT_FALSE(store_->bundle(stage(ended), 0));
  EXPECT_TRUE(store_->bundle(stage(other), 0));
  store_->drop_shared_work(other.seq);
  EXPECT_FALSE(store_->bundle(stage(other), 0));
  EXPECT_EQ(helped(), "nobody");
}

}  // namespace
}  // namespace unwrapd::server::store
