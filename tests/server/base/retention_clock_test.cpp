// How long things are kept, and when webhooks are called, where the time of day is set.
#include "server/base/retention_clock.hpp"

#include <gtest/gtest.h>

#include "server/blobs/blob_store.hpp"
#include "server/database/sqlite_database.hpp"
#include "server/store/job_store.hpp"
#include "server/store/mesh_store.hpp"
#include "server/store/sweeper.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server {
namespace {

/// A server's stores, on clocks that are set at will.
class ClockThatIsSet : public testing::Test {
 protected:
  static constexpr std::int64_t kDay = 86'400'000;

  void pass(std::int64_t ms) {
    times_.of_day_ms += ms;
    times_.elapsed_ms += ms;
  }
  void set_by(std::int64_t ms) { times_.of_day_ms += ms; }

  /// A job, called j_1, that ends now, and a mesh that is used now.
  void finish() {
    const Moment now = store_.now();
    meshes_.put({.id = "m_1",
                 .owner = "",
                 .sha256 = "ab",
                 .media_type = "",
                 .kept_since_ms = now.kept_ms()});
    store::JobRecord job;
    job.id = "j_1";
    job.webhook = "x";
    job.options = job.notes = api::Json::array();
    store_.insert(job);
    store::JobOutcome outcome;
    outcome.finished_ms = now.of_day_ms;
    outcome.set_by_ms = now.set_by_ms;
    store_.finish(*store_.take(""), outcome);
  }

  void expect_kept_for_100_s() {
    pass(99'000);
    sweeper_.sweep_once();
    EXPECT_TRUE(!store_.find("j_1")->expired && meshes_.has("m_1")) << "99 s have passed";
    pass(2000);
    sweeper_.sweep_once();
    EXPECT_TRUE(store_.find("j_1")->expired && !meshes_.has("m_1")) << "101 s have passed";
  }

  std::int64_t due_ms() const {
    const database::SqliteDatabase deliveries(path());
    database::Statement due(deliveries, "SELECT due_ms FROM deliveries");
    return due.step() ? due.number(0) : 0;
  }

  [[nodiscard]] std::filesystem::path path() const { return dir_.path() / "jobs.sqlite"; }

  TempDir dir_;
  Times times_{.of_day_ms = 50 * kDay, .elapsed_ms = 7000};
  const Log log_{LogLevel::off};
  blobs::BlobStore blobs_{dir_.path()};
  store::JobStore store_{path(), [this] { return times_; }};
  store::MeshStore meshes_{path()};
  store::Sweeper sweeper_{store_, meshes_, blobs_, log_, std::chrono::seconds(100)};
};

TEST_F(ClockThatIsSet, KeepsResultsForTheirTime) {
  finish();
  for (const std::int64_t by_ms : {10 * kDay, -20 * kDay}) {
    set_by(by_ms);
    sweeper_.sweep_once();
    EXPECT_EQ(due_ms(), store_.now().kept_ms()) << "a call is due when it was";
  }
  expect_kept_for_100_s();
}

TEST_F(ClockThatIsSet, KeepsForTheirTimeResultsThatCameBeforeThatWasNoted) {
  for (const std::int64_t by_ms : {-2 * kDay, 2 * kDay}) {
    sweeper_.sweep_once();
    set_by(by_ms);
    finish();
    EXPECT_EQ(store_.find("j_1")->finished_ms, times_.of_day_ms);
    EXPECT_EQ(due_ms(), store_.now().kept_ms()) << "a call is due at once";
    expect_kept_for_100_s();
    store_.remove("j_1");
    database::SqliteDatabase(path()).run("DELETE FROM deliveries");
  }
}

TEST_F(ClockThatIsSet, IsRememberedAtTheNextStart) {
  set_by(10 * kDay);
  sweeper_.sweep_once();
  set_by(-3 * kDay);
  EXPECT_EQ(store_.note_time(), -3 * kDay);
  EXPECT_EQ(store_.note_time(), 0);
  const store::JobStore next(path(), [this] { return times_; });
  EXPECT_EQ(next.now().kept_ms(), 50 * kDay);
}

TEST_F(ClockThatIsSet, BetweenTwoServersOfOneBootIsNotTimeThatHasPassed) {
  times_.boot = "a";
  finish();
  sweeper_.sweep_once();
  for (const std::int64_t by_ms : {2 * kDay, -5 * kDay}) {
    set_by(by_ms);
    pass(40'000);
    store::JobStore next(path(), [this] { return times_; });
    store::Sweeper sweeper(next, meshes_, blobs_, log_, std::chrono::seconds(100));
    sweeper.sweep_once();
    EXPECT_FALSE(next.find("j_1")->expired);
  }
  store::JobStore last(path(), [this] { return times_; });
  EXPECT_EQ(last.now().kept_ms(), 50 * kDay + 80'000);
  pass(21'000);
  store::Sweeper(last, meshes_, blobs_, log_, std::chrono::seconds(100)).sweep_once();
  EXPECT_TRUE(last.find("j_1")->expired) << "101 s have passed";
}

TEST_F(ClockThatIsSet, IsNotBelievedOverABootUnlessThePauseWasShort) {
  struct Case {
    std::int64_t day_ms, kept_ms;
  };
  for (const auto& [day_ms, kept_ms] :
       {Case{2 * kDay, 0}, Case{-3 * kDay, 0}, Case{kLongestBelievedMs, kLongestBelievedMs}}) {
    const TempDir dir;
    Times times{.of_day_ms = 50 * kDay, .elapsed_ms = 900'000, .boot = "a"};
    store::JobStore(dir.path() / "jobs.sqlite", [&] { return times; }).note_time();
    times = {.of_day_ms = 50 * kDay + day_ms, .elapsed_ms = 20'000, .boot = "b"};
    const store::JobStore next(dir.path() / "jobs.sqlite", [&] { return times; });
    EXPECT_EQ(next.now().kept_ms(), 50 * kDay + kept_ms);
  }
}

TEST_F(ClockThatIsSet, MayDrift) {
  set_by(kSetByMs - 1);
  EXPECT_EQ(store_.now().kept_ms(), times_.of_day_ms);
  EXPECT_EQ(store_.note_time(), 0);
}

}  // namespace
}  // namespace unwrapd::server
