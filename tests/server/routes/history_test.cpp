// What is asked of the store with each request costs the same however many jobs it has kept.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <limits>
#include <optional>
#include <string>

#include "server/store/job_store.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::routes {
namespace {

using api::JobState;

/// Steps of SQLite's machine in all statements of this process; no matter how fast it goes.
std::int64_t steps = 0;

int count_steps(unsigned, void*, void* statement, void*) {
  steps += sqlite3_stmt_status(static_cast<sqlite3_stmt*>(statement), SQLITE_STMTSTATUS_VM_STEP, 0);
  return 0;
}

int watch(sqlite3* database, const char**, const sqlite3_api_routines*) {
  return sqlite3_trace_v2(database, SQLITE_TRACE_PROFILE, count_steps, nullptr);
}

class History : public testing::Test {
 protected:
  History() {
    sqlite3_auto_extension(reinterpret_cast<void (*)()>(watch));
    store_.emplace(database_in(dir_.path()));
  }
  ~History() override { sqlite3_reset_auto_extension(); }

  std::int64_t insert(const std::string& owner) {
    store::JobRecord job;
    job.id = "j_" + std::to_string(++count_);
    job.options = job.notes = api::Json::array();
    job.owner = owner;
    job.name = "the same";
    job.content_key = job.id;
    job.stored_bytes = 10;
    return store_->insert(job).seq;
  }

  void keep(const std::string& owner, int jobs) {
    for (int k = 0; k < jobs; ++k) {
      insert(owner);
      store::JobOutcome outcome;
      outcome.finished_ms = count_;
      outcome.stored_bytes = 100;
      store_->finish(*store_->take(owner), outcome);
    }
  }

  template <class Use>
  static std::int64_t steps_of(const Use& use) {
    const std::int64_t before = steps;
    use();
    return steps - before;
  }

  /// Of all that comes with requests: lists, quotas, room on the disk, turns.
  std::int64_t steps_of_requests() {
    std::int64_t all = 0;
    for (const auto& owner : {std::optional<std::string>(), std::optional<std::string>("greedy"),
                              std::optional<std::string>("modest")}) {
      for (const auto& state : {std::optional<JobState>(), std::optional(JobState::queued),
                                std::optional(JobState::succeeded)}) {
        const store::JobFilter filter{.owner = owner, .state = state, .before_seq = 0, .limit = 5};
        all += steps_of([&] { store_->list(filter); });
        store::JobFilter named = filter;
        named.name = "the same";
        all += steps_of([&] { store_->list(named); });
      }
    }
    all += steps_of([&] { store_->usage("greedy"); });
    all += steps_of([&] { store_->evictable_bytes(); });
    all += steps_of([&] { store_->find_same("greedy", "j_1"); });
    all += steps_of([&] { store_->finished_before(std::numeric_limits<std::int64_t>::max(), 1); });
    all += steps_of([&] { store_->forget_before(0); });
    all += steps_of([&] { store_->running(); });
    all += steps_of([&] { store_->counts(); });
    all += steps_of([&] { store_->next_owner(1000); });
    all += steps_of([&] { store_->last_lengths(50); });
    return all + steps_of([&] { keep("modest", 1); });
  }

  TempDir dir_;
  std::optional<store::JobStore> store_;
  std::int64_t count_ = 0;
};

TEST_F(History, OfOneKeyMakesNoRequestSlower) {
  keep("modest", 10);
  keep("greedy", 40);
  const std::int64_t with_few = steps_of_requests();
  ASSERT_GT(with_few, 1000);
  keep("greedy", 400);
  EXPECT_LT(steps_of_requests(), with_few + 100);
}

TEST_F(History, BytesAreThoseOfAllRowsWhateverBecomesOfThem) {
  const auto expect = [&](std::int64_t greedy, std::int64_t modest, std::int64_t evictable) {
    EXPECT_EQ(store_->usage("greedy").stored_bytes, greedy);
    EXPECT_EQ(store_->usage("modest").stored_bytes, modest);
    EXPECT_EQ(store_->evictable_bytes(), evictable);
  };
  keep("greedy", 3);
  keep("modest", 2);
  insert("modest");
  expect(300, 210, 500);
  EXPECT_EQ(store_->usage("modest").live_jobs, 1);
  store_->set_stored_bytes("j_1", 150);
  store_->remove("j_2");
  store_->set_expired("j_4");
  expect(250, 110, 350);
  store_->forget_before(std::numeric_limits<std::int64_t>::max());
  expect(250, 110, 350);
  store_.emplace(database_in(dir_.path()));
  expect(250, 110, 350);
}

}  // namespace
}  // namespace unwrapd::server::routes
