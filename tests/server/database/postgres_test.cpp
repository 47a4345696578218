// What only PostgreSQL has: sessions that are lost while they are used. Run by server.on_postgres;
// the suites of the store know no engine.
#include <gmock/gmock.h>

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "core/base/error.hpp"
#include "server/access/key_store.hpp"
#include "server/base/errors.hpp"
#include "server/base/files.hpp"
#include "server/database/schema.hpp"
#include "server/database/sqlite_database.hpp"
#include "server/store/job_store.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/reason_for.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::database {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::set<int> open_sockets() {
  std::set<int> sockets;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    const std::string what = std::filesystem::read_symlink(entry.path(), gone).string();
    if (what.starts_with("socket:")) sockets.insert(std::stoi(entry.path().filename().string()));
  }
  return sockets;
}

/// Cuts a link on this side alone: the server does not know it while this exists.
class CutLink {
 public:
  explicit CutLink(int link) : kept_(::dup(link)) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    ::close(ends[1]);
    ::dup2(ends[0], link);
    ::close(ends[0]);
  }

 private:
  File kept_;
};

class Postgres : public testing::Test {
 protected:
  void SetUp() override { migrate(*database_); }

  std::shared_ptr<Database> open() const { return DatabaseAddress(address_).open(); }
  /// Ends a session, as a restart does.
  void end_session(std::int64_t pid) {
    Statement end(*other_, "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE pid = ?");
    end.with(pid).run();
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
  const std::shared_ptr<Database> other_ = open();
  const std::shared_ptr<Database> database_ = open();
};

TEST_F(Postgres, ReadsAgainWhatWasCut) {
  const std::int64_t before = pid_of(*database_);
  end_session(pid_of(*database_));
  EXPECT_NE(pid_of(*database_), before);
}

TEST_F(Postgres, MakesAgainAChangeThatWasCut) {
  int calls = 0;
  const int result = database_->transact([&] {
    add("j_1");
    if (++calls == 1) end_session(pid_of(*database_));
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

TEST_F(Postgres, TellsTheDoubtWhereTheNextTryFailsInAnotherWay) {
  other_->transact([&] {
    other_->run(R"sql(
      CREATE SEQUENCE tries;
      CREATE FUNCTION end_session() RETURNS trigger LANGUAGE plpgsql AS
        $$ BEGIN PERFORM pg_terminate_backend(pg_backend_pid()); RETURN NULL; END $$;
      CREATE CONSTRAINT TRIGGER lost_in_commit AFTER INSERT ON deliveries
        DEFERRABLE INITIALLY DEFERRED FOR EACH ROW EXECUTE FUNCTION end_session();
      CREATE FUNCTION refuse_second() RETURNS trigger LANGUAGE plpgsql AS
        $$ BEGIN IF nextval('tries') > 1 THEN RAISE 'no more'; END IF; RETURN NEW; END $$;
      CREATE TRIGGER refused BEFORE INSERT ON writers
        FOR EACH ROW EXECUTE FUNCTION refuse_second();)sql");
  });
  try {
    database_->change([&] { add("j_1"); });
    FAIL() << "nothing was thrown";
  } catch (const StoreAway& away) {
    EXPECT_TRUE(away.in_doubt());
    EXPECT_NE(away.reason().find("no more"), std::string::npos) << away.reason();
    EXPECT_GT(away.seconds(), 0);
  }
  EXPECT_TRUE(database_->was_away());
}

TEST_F(Postgres, LosesPatienceWithWhatEndsEachSession) {
  PostgresAddress hasty = address_;
  hasty.patience = std::chrono::milliseconds(50);
  const std::shared_ptr<Database> database = DatabaseAddress(hasty).open();
  EXPECT_THROW(Statement(*database, "SELECT pg_terminate_backend(pg_backend_pid())").step(),
               StoreAway);
  EXPECT_THROW(database->change([&] {
    Statement(*database, "SELECT pg_terminate_backend(pg_backend_pid())").step();
  }),
               StoreAway);
  EXPECT_TRUE(database->was_away());
}

TEST_F(Postgres, RefusesAChangeThatWouldNotBeHealed) { EXPECT_THROW(add("j_1"), Error); }

TEST_F(Postgres, TellsClientsToComeBackWhereNobodyAnswers) {
  Statement where(*other_, "SHOW unix_socket_directories");
  where.step();
  constexpr const char* kSocket = ".s.PGSQL.5432";
  const std::filesystem::path way = dir_.path() / kSocket;
  std::filesystem::create_symlink(std::filesystem::path(where.text(0)) / kSocket, way);
  const PostgresAddress by_way{.url = address_.url + "&host=" + dir_.path().string(),
                               .patience = std::chrono::milliseconds(10)};
  const std::shared_ptr<Database> database = DatabaseAddress(by_way).open();
  const std::int64_t session = pid_of(*database);
  std::filesystem::remove(way);
  end_session(session);
  try {
    pid_of(*database);
    FAIL() << "nothing was thrown";
  } catch (const StoreAway& away) {
    EXPECT_GT(away.seconds(), 0);
    EXPECT_FALSE(away.in_doubt());
  }
  EXPECT_TRUE(database->was_away());
  EXPECT_THAT(error_of([&] { static_cast<void>(DatabaseAddress(by_way).open()); }).what(),
              Not(HasSubstr(dir_.path().string())));
  std::filesystem::create_symlink(std::filesystem::path(where.text(0)) / kSocket, way);
  EXPECT_THROW(pid_of(*database), StoreAway);  // tries are few
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  EXPECT_NE(pid_of(*database), session);
}

TEST_F(Postgres, LetsOneServerHaveTheStore) {
  const store::JobStore first(address_);
  PostgresAddress hasty = address_;
  hasty.patience = std::chrono::milliseconds(10);
  EXPECT_THAT(reason_for([&] { store::JobStore{hasty}; }), HasSubstr("another unwrapd uses it"));
}

TEST_F(Postgres, HasItsStoreAgainAfterACutThatTheServerDoesNotKnow) {
  const std::set<int> before = open_sockets();
  const std::shared_ptr<Database> holder = open();
  std::set<int> links = open_sockets();
  for (const int other : before) links.erase(other);
  ASSERT_EQ(links.size(), 1);
  holder->claim();
  const CutLink cut(*links.begin());
  holder->change([] {});
  EXPECT_FALSE(holder->was_away());
  PostgresAddress hasty = address_;
  hasty.patience = std::chrono::milliseconds(10);
  EXPECT_NE(
      reason_for([&] { DatabaseAddress(hasty).open()->claim(); }).find("another unwrapd uses it"),
      std::string::npos);
}

TEST_F(Postgres, WithoutAJobTakesNoFilesAway) {
  access::KeyStore(dir_.path(), {}, address_).add(access::ApiKey());
  make_directories(dir_.path() / "blobs" / "j_a");
  const blobs::BlobStore blobs(dir_.path());
  const auto start = [&] { static_cast<void>(store::store_in(dir_.path(), address_, blobs)); };
  EXPECT_THAT(reason_for(start), AllOf(HasSubstr("lists no job"), HasSubstr("load its dump")));
  SqliteDatabase file(dir_.path() / store::kStoreFile);
  migrate(file);
  EXPECT_THAT(reason_for(start), AllOf(HasSubstr(store::kStoreFile), Not(HasSubstr("remove"))));
  database_->transact([&] {
    database_->run(
        "INSERT INTO meshes (id, owner, sha256, bytes, media_type, created_ms,"
        " kept_since_ms, stored_bytes) VALUES ('m_a', '', '', 0, '', 0, 0, 0)");
  });
  start();
  database_->transact([&] { database_->run("DELETE FROM meshes"); });
  start();  // what is left of a mesh that was removed
}

TEST_F(Postgres, IsNotMadeToListItsKeys) {
  const TempDir other;
  const PostgresAddress empty = postgres_of(other.path());
  EXPECT_THAT(reason_for([&] {
                access::KeyStore(other.path() / "none", {}, empty,
                                 access::KeyStore::Tables::existing);
              }),
              HasSubstr("schema 0"));
  EXPECT_FALSE(std::filesystem::exists(other.path() / "none"));
  EXPECT_TRUE(columns(*DatabaseAddress(empty).open(),
                      "SELECT table_name, table_type FROM information_schema.tables"
                      " WHERE table_schema = current_schema()")
                  .empty());
}

TEST_F(Postgres, FindsNothingUnderWhatIsNoText) {
  store::JobStore store(address_);
  EXPECT_FALSE(store.find("j_\xff"));
  EXPECT_FALSE(store.find(std::string("j_\0", 3)));
}

TEST_F(Postgres, HasTheColumnsThatSqliteHas) {
  const store::JobStore jobs(dir_.path() / "jobs.sqlite");
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
                    " AND table_name NOT IN ('writers', 'schema_version', 'events', 'secrets', "
                    "'rates', 'worked_on')"),
            sqlite);
}

}  // namespace
}  // namespace unwrapd::server::database
