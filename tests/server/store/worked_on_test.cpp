// Who has worked on what, as nodes of one PostgreSQL database know it. A file has one node, which
// asks nobody.
#include <gtest/gtest.h>

#include "server/store/job_store.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::store {
namespace {

class WorkedOn : public testing::Test {
 protected:
  void SetUp() override {
    if (address_.url.empty()) return;
    open(one_, "one");
    open(two_, "two");
  }

  void open(std::optional<JobStore>& store, const std::string& id) {
    database::PostgresAddress address = address_;
    address.node = id;
    store.emplace(address, read_clocks, Node{.id = id, .is_shared = true, .keeps_work = true});
  }
  std::int64_t add(const std::string& document) {
    JobRecord job;
    job.id = "j_" + std::to_string(++count_);
    job.input.sha256 = document;
    job.options = api::Json::object();
    return one_->insert(job).seq;
  }
  /// "here", "elsewhere" or "both", of the first job that waits; else empty.
  static std::string known(JobStore& store) {
    const std::vector<WaitingJob> jobs = store.first_waiting("", 4);
    if (jobs.empty()) return "no job";
    if (jobs[0].is_known_here && jobs[0].is_known_elsewhere) return "both";
    return jobs[0].is_known_here ? "here" : jobs[0].is_known_elsewhere ? "elsewhere" : "";
  }

  TempDir dir_;
  const database::PostgresAddress address_ = postgres_of(dir_.path());
  std::optional<JobStore> one_, two_;
  int count_ = 0;
};

TEST_F(WorkedOn, IsKnownOfNodesThatAreThere) {
  if (address_.url.empty()) return;
  const std::int64_t first = add("mesh");
  EXPECT_EQ(known(*one_), "");
  ASSERT_TRUE(one_->take_one(first, 1));
  EXPECT_FALSE(two_->take_one(first, 1)) << "it runs already";
  add("mesh");
  EXPECT_EQ(known(*one_), "here");
  EXPECT_EQ(known(*two_), "") << "that node has never said that it is there";
  one_->announce(1);
  EXPECT_EQ(known(*two_), "elsewhere");
  ASSERT_TRUE(two_->take_one(add("mesh"), 1));
  two_->announce(1);
  EXPECT_EQ(known(*one_), "both");
}

TEST_F(WorkedOn, IsForgottenWithTheNodesMemoryAndAfterAnHour) {
  if (address_.url.empty()) return;
  for (JobStore* store : {&*one_, &*two_}) {
    store->announce(1);
    ASSERT_TRUE(store->take_one(add("mesh"), 1));
  }
  add("mesh");
  one_->forget_old_work();
  EXPECT_EQ(known(*one_), "both");
  one_->forget_own_work();
  EXPECT_EQ(known(*one_), "elsewhere");
  const auto database = database::DatabaseAddress(address_).open();
  database->change(
      [&] { database->run("UPDATE worked_on SET noted = noted - INTERVAL '2 hours'"); });
  one_->forget_old_work();
  EXPECT_EQ(known(*one_), "");
}

}  // namespace
}  // namespace unwrapd::server::store
