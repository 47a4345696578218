// What only PostgreSQL has: sessions that are lost while they are used. Run by server.on_postgres;
// the suites of the store know no engine.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "core/base/error.hpp"
#include "server/access/key_store.hpp"
#include "server/store/job_store.hpp"
#include "server/store/numbered_places.hpp"
#include "server/store/schema.hpp"
#include "server/store/sqlite_database.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::store {
namespace {

TEST(PostgresTexts, HaveTheirPlacesInDollars) {
  EXPECT_EQ(with_dollars("a = ? AND b = ? AND c = '?'"), "a = $1 AND b = $2 AND c = '?'");
  EXPECT_EQ(with_dollars("a = ?2 OR b = ?1 OR c = ?10"), "a = $2 OR b = $1 OR c = $10");
}

class Postgres : public testing::Test {
 protected:
  void SetUp() override { migrate(*database_); }

  std::unique_ptr<Database> open() const { return DatabaseAddress(address_).open(); }
  /// Ends the sessions of this schema, as a restart does.
  void end_sessions() {
    Statement end(*other_, "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE pid = ?");
    end.with(pid_of(*database_)).run();
  }
  static std::int64_t pid_of(const Database& database) {
    Statement pid(database, "SELECT pg_backend_pid()");
    pid.step();
    return pid.number(0);
  }
  void add(const std::string& id) {
    Statement(*database_, "INSERT INTO deliveries (job, url, body, due_ms) VALUES (?, '', '', 1)")
        .with(id)
        .run();
  }
  std::int64_t added() const {
    Statement count(*other_, "SELECT COUNT(*) FROM deliveries");
    count.step();
    return count.number(0);
  }
  static std::set<std::string> columns(const Database& database, const std::string& sql) {
    std::set<std::string> found;
    Statement rows(database, sql);
    while (rows.step()) found.insert(rows.text(0) + "." + rows.text(1));
    return found;
  }

  TempDir dir_;
  const PostgresAddress address_ = postgres_of(dir_.path());
  const std::unique_ptr<Database> other_ = open();
  const std::unique_ptr<Database> database_ = open();
};

TEST_F(Postgres, ReadsAgainWhatWasCut) {
  const std::int64_t before = pid_of(*database_);
  end_sessions();
  EXPECT_NE(pid_of(*database_), before);
}

TEST_F(Postgres, MakesAgainAChangeThatWasCut) {
  int calls = 0;
  const int result = database_->transact([&] {
    add("j_1");
    if (++calls == 1) end_sessions();
    add("j_2");
    return calls;
  });
  EXPECT_EQ(result, 2);
  EXPECT_EQ(added(), 2);
  EXPECT_FALSE(database_->was_away());
}

TEST_F(Postgres, MakesNothingOfAChangeThatFails) {
  EXPECT_THROW(database_->transact([&] {
    add("j_1");
    database_->run("no SQL");
  }),
               Error);
  EXPECT_EQ(added(), 0);
  database_->change([&] { add("j_2"); });
  EXPECT_EQ(added(), 1);
}

TEST_F(Postgres, RefusesAChangeThatWouldNotBeHealed) { EXPECT_THROW(add("j_1"), Error); }

TEST_F(Postgres, TellsClientsToComeBackWhereNobodyAnswers) {
  const PostgresAddress nobody{.url = "postgres://nobody@127.0.0.1:1/none",
                               .patience = std::chrono::milliseconds(10)};
  const Error error = error_of([&] { static_cast<void>(DatabaseAddress(nobody).open()); });
  EXPECT_EQ(error.code(), ErrorCode::storage_failed);
  EXPECT_EQ(std::string(error.what()).find("127.0.0.1"), std::string::npos);
}

TEST_F(Postgres, LetsOneServerHaveTheStore) {
  const JobStore first(address_);
  PostgresAddress hasty = address_;
  hasty.patience = std::chrono::milliseconds(10);
  EXPECT_THROW(JobStore{hasty}, Error);
}

TEST_F(Postgres, FindsNothingUnderWhatIsNoText) {
  JobStore store(address_);
  EXPECT_FALSE(store.find("j_\xff"));
  EXPECT_FALSE(store.find(std::string("j_\0", 3)));
}

TEST_F(Postgres, HasTheColumnsThatSqliteHas) {
  const JobStore jobs(dir_.path() / "jobs.sqlite");
  const access::KeyStore keys(dir_.path());
  std::set<std::string> sqlite;
  for (const char* file : {"jobs.sqlite", "keys.sqlite"})
    sqlite.merge(columns(SqliteDatabase(dir_.path() / file),
                         "SELECT m.name, c.name FROM sqlite_schema AS m"
                         " JOIN pragma_table_info(m.name) AS c"
                         " WHERE m.type = 'table' AND m.name <> 'sqlite_sequence'"));
  EXPECT_EQ(columns(*other_,
                    "SELECT table_name, column_name FROM information_schema.columns"
                    " WHERE table_schema = current_schema()"
                    " AND table_name NOT IN ('writers', 'schema_version')"),
            sqlite);
}

}  // namespace
}  // namespace unwrapd::server::store
