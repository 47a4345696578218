// What earlier versions and other settings have accepted is still done, and known again by name.
#include "tests/server/running_server.hpp"

#include <gtest/gtest.h>

#include "server/database/schema.hpp"
#include "server/database/sqlite_database.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::database {
namespace {

/// The options of a job as version 0.1.0 resolved them.
constexpr const char* kFirstOptions =
    R"({"method":"arap","lambda":null,"lambda_units":"dimensionless","iterations":7,)"
    R"("initial":"auto","pins":"diameter","seams":"auto","resolution":1024,"padding":2,)"
    R"("output":"auto"})";

class Upgrade : public RunningServer {
 protected:
  Upgrade() {
    config_.workers = 1;
    config_.drain_seconds = 0;
  }

  /// Stops the server, changes its store as nobody else does, and starts it again.
  void restart_with(const std::string& sql) {
    service_->drain();
    service_.reset();
    SqliteDatabase(dir_.path() / "jobs.sqlite").run(sql.c_str());
    start();
  }
  httplib::Result send(const std::string& name, int size, const std::string& query = "") {
    return client().Post("/v1/jobs" + query, {{"Idempotency-Key", name}}, grid_obj(size),
                         "model/obj");
  }
  static std::string id_of(const httplib::Result& answer) {
    return api::Json::parse(answer->body).at("id");
  }
};

TEST_F(Upgrade, JobsThatTheFirstVersionAcceptedAreDone) {
  start();
  const std::string ahead = submit_endless();
  await_state(ahead, "running");
  const std::string id = submit();
  restart_with("UPDATE jobs SET options = '" + std::string(kFirstOptions) + "' WHERE id = '" + id +
               "'; UPDATE jobs SET asked = ''");
  client().Delete("/v1/jobs/" + ahead);
  await_state(id, "succeeded");
  EXPECT_EQ(get(id, "layout.svg")->status, 200);
}

TEST_F(Upgrade, JobsAreDoneThoughTheLimitsAreLowerNow) {
  start();
  const std::string ahead = submit_endless();
  await_state(ahead, "running");
  const std::string id = submit("?stop.iterations=50");
  client().Delete("/v1/jobs/" + ahead);
  config_.limits.max_iterations = 20;
  restart();
  await_state(id, "succeeded");
  const auto refused = client().Post("/v1/jobs?stop.iterations=50", grid_obj(4), "model/obj");
  expect_problem(refused, 422, "invalid_option");
}

TEST_F(Upgrade, ARequestIsKnownAgainByItsName) {
  start();
  const std::string id = id_of(send("one", 4));
  for (const std::string asked : {"asked", "''"}) {  // as by a version between, and by 0.1.0
    restart_with("UPDATE jobs SET content_key = 'of another version', asked = " + asked);
    EXPECT_EQ(id_of(send("one", 4)), id);
    expect_problem(send("one", 5), 409, "idempotency_conflict");
    expect_problem(send("one", 4, "?resolution=512"), 409, "idempotency_conflict");
  }
  restart_with("UPDATE jobs SET options = '" + std::string(kFirstOptions) + "'");
  EXPECT_EQ(id_of(send("one", 4, "?stop.iterations=7")), id) << "as 0.1.0 wrote them";
  expect_problem(send("one", 4), 409, "idempotency_conflict");
  restart_with("DELETE FROM jobs");
  static_cast<void>(send("two", 4));
  expect_problem(send("two", 4, "?resolution=512"), 409, "idempotency_conflict");
}

/// Version 8 kept answers that were another method's map. A question is asked anew, what was
/// answered stays under its name.
TEST(Schema, AnswersOfVersionEightAreGivenToNoNewQuestion) {
  TempDir dir;
  SqliteDatabase database(dir.path() / "jobs.sqlite");
  migrate(database, 8);
  for (const char* state : {"succeeded", "queued"})
    database.run(("INSERT INTO jobs (id, state, created_ms, synchronous, options, notes, sha256, "
                  "bytes, buffers, content_key) VALUES ('" +
                  std::string(state) + "', '" + state +
                  "', 1, 0, '{}', '[]', '', 0, '[]', 'the question')")
                     .c_str());
  migrate(database);
  Statement answered(database, "SELECT id FROM jobs WHERE content_key = 'the question'");
  ASSERT_TRUE(answered.step());
  EXPECT_EQ(answered.text(0), "queued");
  EXPECT_FALSE(answered.step());
  Statement all(database, "SELECT COUNT(*) FROM jobs");
  all.step();
  EXPECT_EQ(all.number(0), 2);
}

TEST(Schema, JobsOfVersionTenHaveNoName) {
  TempDir dir;
  SqliteDatabase database(dir.path() / "jobs.sqlite");
  migrate(database, 10);
  database.run(
      "INSERT INTO jobs (id, state, created_ms, synchronous, options, notes, sha256, bytes,"
      " buffers) VALUES ('old', 'queued', 1, 0, '{}', '[]', '', 0, '[]')");
  migrate(database);
  Statement old(database, "SELECT id FROM jobs WHERE name = ''");
  ASSERT_TRUE(old.step());
  EXPECT_EQ(old.text(0), "old");
}

TEST(Schema, JobsOfVersionTwelveHaveTheirTurns) {
  TempDir dir;
  {
    SqliteDatabase database(dir.path() / "jobs.sqlite");
    migrate(database, 12);
    for (const char* state : {"queued", "queued", "running", "failed"})
      database.run(
          std::string("INSERT INTO jobs (id, state, created_ms, synchronous, options, "
                      "notes, sha256, bytes, buffers, owner) VALUES (hex(randomblob(9)), '") +
          state + "', 1, 0, '{}', '[]', '', 0, '[]', 'k_a')");
  }
  store::JobStore store(dir.path() / "jobs.sqlite");
  EXPECT_EQ(store.counts().waiting, 2);
  EXPECT_EQ(store.counts().running, 1);
  EXPECT_EQ(store.next_owner(1000), "k_a");
}

TEST_F(Upgrade, OfAJobWithoutItsMapTheResultIsThere) {
  start();
  const std::string id = submit();
  await_state(id, "succeeded");
  const std::string digests = (dir_.path() / "blobs" / id / "digests").string();
  std::filesystem::remove(dir_.path() / "blobs" / id / "uv.bin");
  write_file(digests, [&] {
    std::string kept;
    const std::string all = read_file(digests);
    for (std::size_t at = 0; at < all.size(); at = all.find('\n', at) + 1) {
      const std::string line = all.substr(at, all.find('\n', at) + 1 - at);
      if (line.find("uv.bin") == std::string::npos) kept += line;
    }
    return kept;
  }());
  EXPECT_EQ(get(id, "result")->status, 200);
  EXPECT_EQ(get(id, "report")->status, 200);
  for (const char* what : {"layout.svg", "layout.png", "preview.png"})
    expect_problem(get(id, what), 410, "result_expired");
}

}  // namespace
}  // namespace unwrapd::server::database
