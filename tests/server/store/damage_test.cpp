// A data directory that is damaged, or older in one part than in the other: what can be served is
// served, what cannot is told, and nothing is deleted for it.
#include <gmock/gmock.h>

#include <fstream>

#include "server/database/sqlite_database.hpp"
#include "server/store/data_directory.hpp"
#include "server/store/job_store.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::store {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Damage : public RunningServer {
 protected:
  Damage() {
    config_.workers = 1;
    config_.drain_seconds = 0;
  }

  [[nodiscard]] fs::path store() const { return config_.data / kStoreFile; }
  [[nodiscard]] fs::path blob(const std::string& id) const { return config_.data / "blobs" / id; }
  [[nodiscard]] fs::path lost(const std::string& id) const { return config_.data / "lost" / id; }

  void stop() {
    service_->drain();
    service_.reset();
  }
  /// Starts a server that logs; returns what it has logged until then.
  std::string start_and_hear() {
    testing::internal::CaptureStderr();
    static const Log log(LogLevel::warning);
    service_ = std::make_unique<Service>(config_, log);
    return testing::internal::GetCapturedStderr();
  }
  std::string succeeded(const std::string& query = "") {
    const std::string id = submit(query);
    await_state(id, "succeeded");
    return id;
  }
  void damage_table(const std::string& name) const {
    database::SqliteDatabase database(store());
    database.run("PRAGMA wal_checkpoint(TRUNCATE)");
    database::Statement page(database,
                             "SELECT rootpage, (SELECT page_size FROM pragma_page_size)"
                             " FROM sqlite_schema WHERE name = '" +
                                 name + "'");
    ASSERT_TRUE(page.step());
    std::fstream file(store(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp((page.number(0) - 1) * page.number(1));
    file << std::string(400, '\xa5');
  }
};

TEST_F(Damage, ADamagedPageIsFoundAtTheStartAndNothingIsTouched) {
  start();
  const std::string id = succeeded();
  stop();
  fs::copy(store(), dir_.path() / "whole");
  for (const char* table : {"jobs", "jobs_by_state", "written", "meshes", "deliveries"}) {
    damage_table(table);
    EXPECT_THAT(error_of([this] { start(); }).what(), HasSubstr("jobs.sqlite")) << table;
    EXPECT_TRUE(fs::exists(blob(id) / "report.json"));
    for (const char* rest : {"", "-wal", "-shm"}) fs::remove(store().string() + rest);
    fs::copy(dir_.path() / "whole", store());
  }
  start();
  EXPECT_EQ(get(id, "report")->status, 200);
}

TEST_F(Damage, ThatComesLaterIsSeenByReadinessAndToldToClientsWithoutItsReason) {
  start();
  const std::string id = succeeded();
  EXPECT_EQ(client().Get("/readyz")->status, 200);
  damage_table("jobs");
  database::SqliteDatabase(store()).run(
      "UPDATE written SET times = times + 1");  // so that pages are read anew
  const auto answer = client().Get("/v1/jobs/" + id);
  expect_problem(answer, 500, "storage_failed");
  EXPECT_THAT(answer->body,
              AllOf(HasSubstr("damaged"), Not(HasSubstr("malformed")), Not(HasSubstr("sqlite"))));
  for (int again = 0; again < 2; ++again)
    expect_problem(client().Get("/readyz"), 500, "storage_failed");
}

TEST_F(Damage, TheLogHasTheReasonThatClientsAreNotTold) {
  const std::string started = start_and_hear();
  database::SqliteDatabase(store()).run("ALTER TABLE jobs RENAME TO away");
  testing::internal::CaptureStderr();
  const auto answer = client().Get("/v1/jobs");
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("no such table"));
  expect_problem(answer, 500, "storage_failed");
  EXPECT_THAT(answer->body, AllOf(Not(HasSubstr("no such table")), Not(HasSubstr("sqlite"))));
}

TEST_F(Damage, WhatAnOlderDatabaseDoesNotKnowIsSetAsideAndComesBackWithTheNewerOne) {
  start();
  const std::string first = succeeded();
  stop();
  fs::copy(store(), dir_.path() / "older");
  start();
  const std::string second = succeeded("?resolution=512");
  stop();
  fs::rename(store(), dir_.path() / "newer");
  fs::copy(dir_.path() / "older", store());
  EXPECT_THAT(start_and_hear(), AllOf(HasSubstr("lost"), HasSubstr(second)));
  EXPECT_EQ(get(first, "result")->status, 200);
  EXPECT_EQ(client().Get("/v1/jobs/" + second)->status, 404);
  EXPECT_TRUE(fs::exists(lost(second) / "result.obj") && !fs::exists(blob(second)));
  stop();
  fs::rename(dir_.path() / "newer", store());
  EXPECT_THAT(start_and_hear(), HasSubstr("in the database again"));
  for (const std::string& id : {first, second}) EXPECT_EQ(get(id, "result")->status, 200);
  EXPECT_TRUE(fs::is_empty(config_.data / "lost"));
}

TEST_F(Damage, AFileOrLinkInAFoldersPlaceCostsThatJobAlone) {
  start();
  const std::string file = succeeded();
  const std::string link = succeeded("?resolution=512");
  const std::string ahead = submit_endless();
  await_state(ahead, "running");
  const std::string waiting = submit("?resolution=64");
  const std::string whole = submit("?resolution=128");
  stop();
  const fs::path elsewhere = dir_.path() / "elsewhere";
  fs::create_directories(elsewhere);
  write_file(elsewhere / "of-another.part", "x");
  for (const std::string& id : {file, link, waiting}) fs::remove_all(blob(id));
  for (const std::string& id : {file, waiting}) write_file(blob(id), "x");
  fs::create_directory_symlink(elsewhere, blob(link));
  EXPECT_THAT(start_and_hear(), AllOf(HasSubstr(file), HasSubstr(link), HasSubstr(waiting)));
  client().Delete("/v1/jobs/" + ahead);
  for (const std::string& id : {file, link})
    expect_problem(get(id, "result"), 500, "storage_corrupt");
  EXPECT_TRUE(fs::exists(elsewhere / "of-another.part")) << "is nobody's to sweep";
  await_state(waiting, "failed");
  EXPECT_EQ(job(waiting).at("problem").at("code"), "storage_corrupt");
  await_state(whole, "succeeded");
}

/// What a row may come to look like. %s: the job's id.
constexpr const char* kDamages[] = {
    "options = '{\"met'",   "options = CAST(x'7b2261223aff7d' AS TEXT)",
    "notes = '{}'",         "buffers = '[1]'",
    "problem = 'nul'",      "state = 'paused'",
    "attempt = 2147483648",
};

TEST_F(Damage, ARowThatCannotBeReadIsSetAsideAndNamedAndTheOthersGoOn) {
  for (const char* damage : kDamages) {
    const TempDir dir;
    config_.data = dir.path();
    start();
    const std::string done = succeeded();
    const std::string ahead = submit_endless();
    await_state(ahead, "running");
    const std::string waiting = submit("?resolution=64");
    const std::string whole = submit("?resolution=128");
    stop();
    database::SqliteDatabase(store()).run(("UPDATE jobs SET " + std::string(damage) +
                                           " WHERE id IN ('" + done + "', '" + waiting +
                                           "'); UPDATE stored SET bytes = -5000000000")
                                              .c_str());
    EXPECT_THAT(start_and_hear(), AllOf(HasSubstr(done), HasSubstr(waiting))) << damage;
    const bool has_ended =
        client().Delete("/v1/jobs/" + ahead)->status == 204;  // on a slow machine
    await_state(whole, "succeeded");
    const auto list = client().Get("/v1/jobs");
    EXPECT_EQ(api::Json::parse(list->body).at("jobs").size(), has_ended ? 3U : 4U) << damage;
    for (const std::string& id : {done, waiting}) {
      EXPECT_EQ(job(id).at("problem").at("code"), "storage_corrupt") << damage;
      expect_problem(get(id, "result"), 500, "storage_corrupt");
      EXPECT_TRUE(fs::exists(lost(id) / "document")) << damage;
    }
    EXPECT_EQ(client().Get("/readyz")->status, 200);
    stop();
    EXPECT_GE(JobStore(store()).usage("").stored_bytes, 0);
  }
}

TEST_F(Damage, ARowDamagedWhileItWaitsIsPassedOver) {
  start();
  const std::string ahead = submit_endless();
  await_state(ahead, "running");
  const std::string waiting = submit("?resolution=64");
  const std::string whole = submit("?resolution=128");
  database::SqliteDatabase(store()).run(
      ("UPDATE jobs SET options = '{' WHERE id = '" + waiting + "'").c_str());
  client().Delete("/v1/jobs/" + ahead);
  await_state(whole, "succeeded");
  EXPECT_EQ(job(waiting).at("state"), "failed");
}

TEST_F(Damage, AnIdThatIsAPathTakesNothingWithIt) {
  config_.keep_seconds = 1;
  start();
  const std::string id = succeeded();
  stop();
  const fs::path outside = dir_.path() / "outside";
  write_file(outside, "x");
  database::SqliteDatabase database(store());
  for (const char* path : {"", ".", "..", "../outside"}) {
    database.run(("INSERT INTO jobs (id, state, created_ms, synchronous, options, notes, sha256,"
                  " bytes, buffers) VALUES ('" +
                  std::string(path) + "', 'succeeded', 1, 0, '{}', '[]', '', 0, '[]')")
                     .c_str());
  }
  start();
  await([&] { return client().Get("/v1/jobs/" + id)->status == 404; });  // a sweep has passed
  EXPECT_TRUE(fs::exists(outside) && fs::exists(config_.data / "blobs") && fs::exists(store()));
}

class Lost : public testing::Test {
 protected:
  void make(const std::string& name, std::size_t bytes) const {
    fs::create_directories(dir_.path() / "blobs" / name);
    write_file(dir_.path() / "blobs" / name / "result.obj", std::string(bytes, 'x'));
  }
  [[nodiscard]] bool has(const std::string& name) const {
    return fs::exists(dir_.path() / "lost" / name);
  }
  static blobs::FolderFate unknown(const std::string&) { return blobs::FolderFate::unknown; }

  const TempDir dir_;
  blobs::BlobStore blobs_{dir_.path()};
};

TEST_F(Lost, IsKeptForItsTimeAndNoLonger) {
  make("j_1", 10);
  EXPECT_EQ(blobs_.sweep(unknown, 5000).lost, std::vector<std::string>{"j_1"});
  make("j_1", 20);
  EXPECT_EQ(blobs_.sweep(unknown, 7000).lost, std::vector<std::string>{"j_1"});
  EXPECT_TRUE(has("j_1") && has("j_1~2"));
  EXPECT_EQ(blobs_.room().used_bytes(), 30);
  EXPECT_EQ(blobs_.lost().sweep(5000), 0);
  EXPECT_EQ(blobs_.lost().sweep(5001), 1);
  EXPECT_TRUE(!has("j_1") && has("j_1~2"));
  EXPECT_EQ(blobs_.room().used_bytes(), 20);
}

TEST_F(Lost, CountsAfterARestartAndGoesFirst) {
  make("j_1", 10);
  static_cast<void>(blobs_.sweep(unknown, 5000));
  blobs::BlobStore next(dir_.path());
  EXPECT_EQ(next.sweep(unknown, 6000).returned, 0);
  EXPECT_EQ(next.lost().bytes(), 10);
  EXPECT_TRUE(next.lost().give_up_first());
  EXPECT_FALSE(next.lost().give_up_first());
  EXPECT_EQ(next.room().used_bytes(), 0);
}

TEST_F(Lost, GoesWhenTheDiskIsFull) {
  for (const char* name : {"j_1", "j_2"}) make(name, 10);
  blobs::BlobStore full(dir_.path(), {.max_bytes = 0, .min_free_bytes = std::int64_t{1} << 60});
  static_cast<void>(full.sweep(unknown, 5000));
  full.room().on_shortage({.evict =
                               [] {
                                 ADD_FAILURE() << "a result was given up";
                                 return false;
                               },
                           .bytes = [] { return 0; },
                           .give_up_lost = [&] { return full.lost().give_up_first(); }});
  EXPECT_EQ(error_of([&] { full.room().take("j_3", 1); }).code(), ErrorCode::storage_full);
  EXPECT_TRUE(!has("j_1") && !has("j_2"));
  EXPECT_EQ(full.room().used_bytes(), 0);
}

}  // namespace
}  // namespace unwrapd::server::store
