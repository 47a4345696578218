// What the files of jobs are counted for, when they cannot be written or can be made again.
#include "server/blobs/disk_budget.hpp"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>

#include "server/blobs/blob_store.hpp"
#include "server/jobs/disk_full_backoff.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::blobs {
namespace {

/// A job with a document and a result.
void add_sealed(BlobStore& blobs, const std::string& id) {
  write_file(blobs.begin_upload("u") / kDocumentFile, "v 0 0 0");
  blobs.keep_upload("u", id);
  blobs.write_unsealed(id, 1, kReportFile, "{}");
  blobs.seal(id, 1);
}

class FilesOfJobs : public testing::Test {
 protected:
  TempDir dir_;
};

TEST_F(FilesOfJobs, ThatGoMakeRoomForTheReserveAtOnce) {
  BlobStore blobs(dir_.path(), {.max_bytes = 0, .min_free_bytes = 0});
  add_sealed(blobs, "j_1");
  EXPECT_FALSE(std::filesystem::exists(dir_.path() / "reserve"));
  blobs.remove("j_1");
  EXPECT_TRUE(std::filesystem::exists(dir_.path() / "reserve"));
}

TEST_F(FilesOfJobs, ThatCanBeMadeAgainTakeNothingFromOthers) {
  BlobStore blobs(dir_.path(), {.max_bytes = 1000, .min_free_bytes = 0});
  add_sealed(blobs, "j_1");
  const std::int64_t before = blobs.room().used_bytes();
  blobs.room().on_shortage({.evict =
                                [] {
                                  ADD_FAILURE() << "something was given up";
                                  return false;
                                },
                            .bytes = [] { return 1000; }});
  EXPECT_FALSE(blobs.try_keep("j_1", "picture", std::string(751, 'x')));
  EXPECT_TRUE(blobs.try_keep("j_1", "picture", std::string(500, 'x')));
  EXPECT_EQ(blobs.room().used_bytes(), before + 500);
  const std::shared_ptr<const File> lent = blobs.lend(std::string(2000, 'y'));
  EXPECT_EQ(lent->read(0, 3000), std::string(2000, 'y'));
  EXPECT_EQ(blobs.room().used_bytes(), before + 500);
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "incoming"));
}

TEST_F(FilesOfJobs, ThatCannotBeWrittenTakesNoRoom) {
  BlobStore blobs(dir_.path(), {.max_bytes = 1000, .min_free_bytes = 0});
  add_sealed(blobs, "j_1");
  const std::int64_t before = blobs.room().used_bytes();
  std::filesystem::create_directories(blobs.path("j_1", "taken") / "by a folder");
  EXPECT_EQ(error_of([&] { blobs.write_unsealed("j_1", 1, "taken", "1234"); }).code(),
            ErrorCode::storage_failed);
  EXPECT_EQ(error_of([&] { blobs.write_unsealed("j_gone", 1, "file", "1234"); }).code(),
            ErrorCode::storage_failed);
  EXPECT_EQ(error_of([&] { static_cast<void>(blobs.try_keep("j_gone", "file", "1234")); }).code(),
            ErrorCode::storage_failed);
  EXPECT_EQ(blobs.room().used_bytes(), before);
  for (const auto& entry : std::filesystem::directory_iterator(blobs.path("j_1", "")))
    EXPECT_FALSE(is_unfinished(entry.path())) << entry.path();
}

TEST_F(FilesOfJobs, AreClaimedUntilTheyCount) {
  BlobStore blobs(dir_.path());
  add_sealed(blobs, "j_1");
  bool allowed = false;
  std::int64_t claimed = 0, counted = 0;
  const auto reservation = [&](const std::string&, std::int64_t seq,
                               std::int64_t bytes) -> std::shared_ptr<void> {
    EXPECT_EQ(seq, 5);
    if (!allowed) return nullptr;
    claimed = bytes;
    return {&claimed, [&](void*) { claimed = 0; }};
  };
  const auto kept = [&](std::string_view, std::int64_t bytes) {
    EXPECT_EQ(claimed, 7);
    counted = bytes;
  };
  blobs.on_keeping({.reservation = reservation, .kept = kept});
  EXPECT_FALSE(blobs.try_keep("j_1", "picture", "1234567", 5));
  allowed = true;
  EXPECT_TRUE(blobs.try_keep("j_1", "picture", "1234567", 5));
  EXPECT_EQ(counted, 16) << "the document, the report and the picture: digests are ours";
  EXPECT_EQ(claimed, 0);
}

TEST(DiskFullBackoff, GrowsWithEachJobInARowThatFindsTheDiskFull) {
  jobs::DiskFullBackoff pause;
  EXPECT_EQ(pause.seconds_left(), 0);
  for (const int seconds : {1, 2, 4, 8, 16, 32, 60, 60}) {
    pause.note(true);
    EXPECT_EQ(pause.seconds_left(), seconds);
  }
  pause.note(false);
  pause.note(true);
  EXPECT_EQ(pause.seconds_left(), 1);
}

TEST_F(FilesOfJobs, ThatAnswerAgainCountOnceForTheOneThatIsLeft) {
  constexpr std::int64_t kDocument = 7;
  BlobStore blobs(dir_.path());
  std::map<std::string, std::int64_t> told;
  blobs.on_keeping(
      {.kept = [&](std::string_view job, std::int64_t bytes) { told[std::string(job)] = bytes; }});
  add_sealed(blobs, "j_1");
  blobs.write_unsealed("j_1", 1, kUvFile, std::string(1000, 'x'));
  const std::int64_t first = blobs.seal("j_1", 1);
  EXPECT_EQ(first, blobs.room().used_bytes());
  for (const char* again : {"j_2", "j_3"}) {
    write_file(blobs.begin_upload("u") / kDocumentFile, "v 0 0 0");
    blobs.keep_upload("u", again);
    ASSERT_TRUE(blobs.adopt(again, "j_1"));
    EXPECT_EQ(blobs.bytes(again), kDocument);
    EXPECT_EQ(blobs.bytes("j_1"), first);
  }
  EXPECT_EQ(blobs.room().used_bytes(), first + 2 * kDocument);
  BlobStore restarted(dir_.path());
  const Swept swept = restarted.sweep([](const std::string&) { return FolderFate::kept; }, 0);
  EXPECT_EQ(swept.sharing.size(), 3U);
  EXPECT_EQ(restarted.room().used_bytes(), first + 2 * kDocument);
  blobs.remove("j_1");
  EXPECT_EQ(told, (std::map<std::string, std::int64_t>{{"j_2", first}}));
  EXPECT_EQ(blobs.room().used_bytes(), first + kDocument);
  blobs.remove("j_2");
  EXPECT_EQ(told["j_3"], first);
  blobs.remove("j_3");
  EXPECT_EQ(blobs.room().used_bytes(), 0);
}

TEST_F(FilesOfJobs, CountThoughABackupHasLinksToThem) {
  BlobStore blobs(dir_.path());
  add_sealed(blobs, "j_1");
  const std::int64_t before = blobs.bytes("j_1");
  for (const std::string_view file : {kDocumentFile, kReportFile})
    std::filesystem::create_hard_link(blobs.path("j_1", file), dir_.path() / file);
  EXPECT_EQ(blobs.bytes("j_1"), before);
  EXPECT_FALSE(blobs.is_shared("j_1"));
}

TEST_F(FilesOfJobs, ThatAreMadeAgainCountForEach) {
  BlobStore blobs(dir_.path());
  add_sealed(blobs, "j_1");
  write_file(blobs.begin_upload("u") / kDocumentFile, "v 0 0 0");
  blobs.keep_upload("u", "j_2");
  ASSERT_TRUE(blobs.adopt("j_2", "j_1"));
  const std::int64_t alone = blobs.bytes("j_2");
  write_file(blobs.path("j_1", kReportFile), "{}");
  EXPECT_EQ(blobs.bytes("j_1"), alone + 2);
  EXPECT_EQ(blobs.room().used_bytes(), 2 * (alone + 2));
}

}  // namespace
}  // namespace unwrapd::server::blobs
