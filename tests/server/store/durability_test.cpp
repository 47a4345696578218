// What keeps jobs over versions, damaged disks and full disks; and whose job is next. Each rule by
// itself; tests/fault kills the real server.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <memory>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/base/identity.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/blobs/digests.hpp"
#include "server/database/sqlite_database.hpp"
#include "server/store/job_store.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::store {
namespace {

using api::JobState;

/// The tables as version 0.1.0 made them, with a job that waits and one that has ended.
constexpr const char* kVersion1 = R"sql(
CREATE TABLE jobs (
  seq INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE, state TEXT NOT NULL,
  created_ms INTEGER NOT NULL, finished_ms INTEGER NOT NULL DEFAULT 0,
  attempt INTEGER NOT NULL DEFAULT 0, crashes INTEGER NOT NULL DEFAULT 0,
  cancel_requested INTEGER NOT NULL DEFAULT 0, synchronous INTEGER NOT NULL,
  expired INTEGER NOT NULL DEFAULT 0, options TEXT NOT NULL, notes TEXT NOT NULL,
  sha256 TEXT NOT NULL, bytes INTEGER NOT NULL, buffers TEXT NOT NULL,
  result_format TEXT NOT NULL DEFAULT '', problem TEXT NOT NULL DEFAULT 'null',
  last_event INTEGER NOT NULL DEFAULT 0
) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, seq);
INSERT INTO jobs (id, state, created_ms, synchronous, options, notes, sha256, bytes, buffers)
  VALUES ('j_1', 'queued', 5, 0, '{"method":"arap"}', '["n"]', 'ab', 7, '[["a.bin","buffer_0"]]');
INSERT INTO jobs (id, state, created_ms, finished_ms, attempt, synchronous, options, notes, sha256,
                  bytes, buffers, result_format)
  VALUES ('j_2', 'succeeded', 6, 9, 1, 1, '{}', '[]', 'cd', 8, '[]', 'obj');
PRAGMA user_version = 1;
)sql";

class Durability : public testing::Test {
 protected:
  std::filesystem::path path() const { return dir_.path() / "jobs.sqlite"; }

  /// A job with a document and a result, sealed.
  void add_job(blobs::BlobStore& blobs, const std::string& id) const {
    const std::filesystem::path folder = blobs.begin_upload("u");
    write_file(folder / blobs::kDocumentFile, "v 0 0 0");
    blobs.keep_upload("u", id);
    blobs.write_unsealed(id, 1, blobs::kReportFile, "{}");
    blobs.seal(id, 1);
  }

  static void damage(const std::filesystem::path& file) { write_file(file, "v 0 0 1"); }

  TempDir dir_;
};

TEST_F(Durability, AFileOfTheFirstVersionIsBroughtToThisOne) {
  std::filesystem::create_directories(dir_.path());
  database::SqliteDatabase(path()).run(kVersion1);
  for (int opening = 0; opening < 2; ++opening) {
    JobStore store(path());
    const JobRecord waiting = *store.find("j_1");
    EXPECT_EQ(waiting.state, JobState::queued);
    EXPECT_EQ(waiting.options, (api::Json{{"method", "arap"}}));
    EXPECT_EQ(waiting.input.buffers.at(0).uri, "a.bin");
    EXPECT_EQ(waiting.urgency, kUsualUrgency);
    EXPECT_EQ(waiting.owner, "");
    EXPECT_EQ(store.find("j_2")->result_format, "obj");
    EXPECT_EQ(store.usage("").stored_bytes, 15);
    EXPECT_TRUE(store.finished_before(9).empty());
    EXPECT_EQ(store.finished_before(10).size(), 1U);
  }
  EXPECT_EQ(JobStore(path()).take("")->id, "j_1");
}

TEST_F(Durability, ADamagedFileIsNeverHandedOut) {
  blobs::BlobStore blobs(dir_.path());
  add_job(blobs, "j_1");
  EXPECT_EQ(blobs.read("j_1", blobs::kDocumentFile), "v 0 0 0");
  EXPECT_EQ(blobs.digest("j_1", blobs::kReportFile), sha256("{}"));
  damage(blobs.path("j_1", blobs::kDocumentFile));
  damage(blobs.path("j_1", blobs::kReportFile));
  for (const std::string_view file : {blobs::kDocumentFile, blobs::kReportFile}) {
    EXPECT_EQ(error_of([&] { static_cast<void>(blobs.open("j_1", file)); }).code(),
              ErrorCode::storage_corrupt)
        << file;
  }
}

TEST_F(Durability, APipeInThePlaceOfAFileHoldsNobody) {
  blobs::BlobStore blobs(dir_.path(), {});
  add_job(blobs, "j_1");
  const std::filesystem::path file = blobs.path("j_1", blobs::kReportFile);
  std::filesystem::remove(file);
  ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
  EXPECT_EQ(error_of([&] { static_cast<void>(File::open(file)); }).code(),
            ErrorCode::storage_failed);
}

TEST_F(Durability, AnUploadDamagedBeforeItIsAJobIsNotTakenForWhatCame) {
  blobs::BlobStore blobs(dir_.path());
  const std::filesystem::path folder = blobs.begin_upload("u");
  write_file(folder / blobs::kDocumentFile, "v 0 0 0");
  damage(folder / blobs::kDocumentFile);
  blobs.keep_upload("u", "j_1", {{std::string(blobs::kDocumentFile), sha256("v 0 0 0")}});
  EXPECT_EQ(error_of([&] { static_cast<void>(blobs.read("j_1", blobs::kDocumentFile)); }).code(),
            ErrorCode::storage_corrupt);
}

TEST_F(Durability, SealingDoesNotPassOverADamagedInput) {
  blobs::BlobStore blobs(dir_.path());
  add_job(blobs, "j_1");
  damage(blobs.path("j_1", blobs::kDocumentFile));
  blobs.write_unsealed("j_1", 1, blobs::kReportFile, "{\"attempt\": 2}");
  blobs.seal("j_1", 1);
  EXPECT_EQ(blobs.read("j_1", blobs::kReportFile), "{\"attempt\": 2}");
  EXPECT_EQ(error_of([&] { static_cast<void>(blobs.read("j_1", blobs::kDocumentFile)); }).code(),
            ErrorCode::storage_corrupt);
}

TEST_F(Durability, SharedResultsOutliveTheJobTheyCameFrom) {
  blobs::BlobStore blobs(dir_.path());
  add_job(blobs, "j_1");
  write_file(blobs.begin_upload("u") / blobs::kDocumentFile, "v 0 0 0");
  blobs.keep_upload("u", "j_2");
  EXPECT_TRUE(blobs.adopt("j_2", "j_1"));
  blobs.remove("j_1");
  EXPECT_EQ(blobs.read("j_2", blobs::kReportFile), "{}");
  EXPECT_FALSE(blobs.adopt("j_2", "j_1"));
}

TEST_F(Durability, ResultsThatAreNotWholeAreGivenToNobody) {
  for (const std::string_view file :
       {blobs::kReportFile, blobs::kTotalsFile, blobs::kUvFile, blobs::kDigestsFile}) {
    blobs::BlobStore blobs(dir_.path());
    add_job(blobs, "j_1");
    blobs.write_unsealed("j_1", 1, blobs::kTotalsFile, "{}");
    blobs.write_unsealed("j_1", 1, blobs::kUvFile, "uv");
    blobs.seal("j_1", 1);
    write_file(blobs.begin_upload("u") / blobs::kDocumentFile, "v 0 0 0");
    blobs.keep_upload("u", "j_2");
    damage(blobs.path("j_1", file));
    EXPECT_FALSE(blobs.adopt("j_2", "j_1")) << file;
    for (const std::string_view given : {blobs::kReportFile, blobs::kTotalsFile, blobs::kUvFile})
      EXPECT_FALSE(std::filesystem::exists(blobs.path("j_2", given))) << given;
    EXPECT_EQ(blobs.read("j_2", blobs::kDocumentFile), "v 0 0 0");
    blobs.remove("j_1");
    blobs.remove("j_2");
  }
}

TEST_F(Durability, AFileThatWasMadeButNotNotedIsNotGivenToAnother) {
  blobs::BlobStore blobs(dir_.path());
  add_job(blobs, "j_1");
  blobs.write_unsealed("j_1", 1, "uv.bin.layout.area.svg", "<svg");
  write_file(blobs.begin_upload("u") / blobs::kDocumentFile, "v 0 0 0");
  blobs.keep_upload("u", "j_2");
  EXPECT_FALSE(blobs.adopt("j_2", "j_1"));
  ASSERT_TRUE(blobs.try_keep("j_1", "uv.bin.layout.area.svg", "<svg"));
  EXPECT_TRUE(blobs.adopt("j_2", "j_1"));
  EXPECT_EQ(blobs.read("j_2", "uv.bin.layout.area.svg"), "<svg");
}

TEST_F(Durability, WithoutItsDigestAFileIsNotHandedOut) {
  blobs::BlobStore blobs(dir_.path());
  add_job(blobs, "j_1");
  const auto expect_refused = [&](std::string_view why) {
    for (const std::string_view file : {blobs::kDocumentFile, blobs::kReportFile}) {
      EXPECT_EQ(error_of([&] { static_cast<void>(blobs.read("j_1", file)); }).code(),
                ErrorCode::storage_corrupt)
          << file << why;
    }
  };
  write_file(blobs.path("j_1", blobs::kDigestsFile), "");
  expect_refused(" whose digests are empty");
  std::filesystem::remove(blobs.path("j_1", blobs::kDigestsFile));
  expect_refused(" whose digests are gone");
  const blobs::BlobStore reopened(dir_.path());
  expect_refused(" whose digests are gone, after another start");
}

TEST_F(Durability, WhatTheFirstVersionStoredIsNotedOnce) {
  make_directories(dir_.path() / "blobs" / "j_1");
  write_file(dir_.path() / "blobs" / "j_1" / blobs::kReportFile, "{}");
  const blobs::BlobStore blobs(dir_.path());
  EXPECT_EQ(blobs.read("j_1", blobs::kReportFile), "{}");
  damage(blobs.path("j_1", blobs::kReportFile));
  EXPECT_EQ(error_of([&] { static_cast<void>(blobs.read("j_1", blobs::kReportFile)); }).code(),
            ErrorCode::storage_corrupt);
}

TEST_F(Durability, WhatHasNoRoomIsRefusedAndTheOldestResultsGoFirst) {
  blobs::BlobStore blobs(dir_.path(), {.max_bytes = 1000, .min_free_bytes = 0});
  std::vector<std::string> evicted;
  EXPECT_EQ(error_of([&] { blobs.room().take_for_upload("u", 751, 751); }).code(),
            ErrorCode::storage_full);
  blobs.room().take_for_upload("u", 750, 750);
  EXPECT_EQ(error_of([&] { blobs.room().take_for_upload("u", 1, 1); }).code(),
            ErrorCode::storage_full);
  blobs.room().take("j_1", 250);
  EXPECT_EQ(error_of([&] { blobs.room().take("j_1", 1); }).code(), ErrorCode::storage_full);
  const auto evict = [&] {
    evicted.emplace_back("u");
    blobs.room().give_back("u");
    return evicted.size() == 1;
  };
  blobs.room().on_shortage({.evict = evict, .bytes = [] { return 750; }});
  blobs.room().take("j_2", 400);
  EXPECT_EQ(evicted.size(), 1U);
  EXPECT_EQ(blobs.room().used_bytes(), 650);
  EXPECT_EQ(error_of([&] { blobs.room().take("j_2", 351); }).code(), ErrorCode::storage_full);
}

TEST_F(Durability, UploadsLeaveTheDiskSomeRoomAndResultsHalfOfIt) {
  const auto free = static_cast<std::int64_t>(std::filesystem::space(dir_.path()).available);
  const auto upload = [](blobs::BlobStore& blobs) { blobs.room().take_for_upload("u", 1, 1); };
  const auto result = [](blobs::BlobStore& blobs) { blobs.room().take("j_1", 1); };
  blobs::BlobStore blobs(dir_.path(), {.max_bytes = 0, .min_free_bytes = free / 2 * 3});
  EXPECT_EQ(error_of([&] { upload(blobs); }).code(), ErrorCode::storage_full);
  EXPECT_NO_THROW(result(blobs));
  blobs::BlobStore fuller(dir_.path(), {.max_bytes = 0, .min_free_bytes = 3 * free});
  EXPECT_EQ(error_of([&] { result(fuller); }).code(), ErrorCode::storage_full);
}

TEST_F(Durability, WhatSaysThatSomethingIsRemovedHasRoomOnAFullDiskOnce) {
  blobs::BlobStore blobs(dir_.path());
  int times = 0;
  const auto write = [&] {
    if (++times % 2 == 1) throw Error(ErrorCode::storage_full, "");
  };
  EXPECT_EQ(error_of([&] { blobs.room().free_by(write); }).code(), ErrorCode::storage_full);
  times = 0;
  blobs.room().make_reserve();
  EXPECT_EQ(std::filesystem::file_size(dir_.path() / "reserve"), blobs::kReserveBytes);
  EXPECT_NO_THROW(blobs.room().free_by(write));
  EXPECT_EQ(times, 2);
  EXPECT_FALSE(std::filesystem::exists(dir_.path() / "reserve"));
}

}  // namespace
}  // namespace unwrapd::server::store
