// What has to be on the disk before an answer says so: every fsync of the process is noted here,
// and the file that it is of must not have changed since.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "server/blobs/blob_store.hpp"
#include "server/blobs/digests.hpp"
#include "server/uploads/job_input.hpp"
#include "tests/server/temp_dir.hpp"

namespace {

using FileId = std::pair<dev_t, ino_t>;
using Time = std::pair<std::int64_t, std::int64_t>;

/// What a file was when it was synced last: a directory's names count, a file's size does.
struct Synced {
  Time changed;
  off_t size;
};

FileId id_of(const struct stat& status) { return {status.st_dev, status.st_ino}; }
Synced state_of(const struct stat& status) {
  return {{status.st_mtim.tv_sec, status.st_mtim.tv_nsec}, status.st_size};
}

std::mutex noting;
std::map<FileId, Synced> synced;
std::vector<std::filesystem::path> noted_early;  // files whose digests were named before they were
bool is_digests_turn = false;  // the other files are synced after the next digests only
std::condition_variable turned;

bool is_of_digests(int descriptor) {
  const std::filesystem::path link = "/proc/self/fd/" + std::to_string(descriptor);
  std::error_code none;
  return std::filesystem::read_symlink(link, none).filename() == "digests.part";
}

bool is_synced(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return false;
  const std::lock_guard lock(noting);
  const auto found = synced.find(id_of(status));
  if (found == synced.end()) return false;
  const Synced now = state_of(status);
  return found->second.changed == now.changed && found->second.size == now.size;
}

}  // namespace

/// In the place of the C library's, for the whole of this program, as the next one.
extern "C" int fsync(int descriptor) {
  const bool of_digests = is_of_digests(descriptor);
  if (std::unique_lock lock(noting); !of_digests)
    turned.wait_for(lock, std::chrono::seconds(10), [] { return !is_digests_turn; });
  struct stat before {};
  const bool is_known = ::fstat(descriptor, &before) == 0;
  const auto result = static_cast<int>(::syscall(SYS_fsync, descriptor));
  const std::lock_guard lock(noting);
  if (is_known && result == 0) synced.insert_or_assign(id_of(before), state_of(before));
  if (of_digests) is_digests_turn = false;
  turned.notify_all();
  return result;
}

extern "C" int rename(const char* from, const char* to) {
  const std::filesystem::path path(to);
  if (path.filename() == unwrapd::server::blobs::kDigestsFile)
    for (const auto& entry : std::filesystem::directory_iterator(path.parent_path()))
      if (entry.path() != path && !is_synced(entry.path())) noted_early.push_back(entry.path());
  return ::renameat(AT_FDCWD, from, AT_FDCWD, to);
}

namespace unwrapd::server::store {
namespace {

/// A folder, and all that is in it.
void expect_synced(const std::filesystem::path& folder) {
  EXPECT_TRUE(is_synced(folder)) << folder;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    EXPECT_TRUE(is_synced(entry.path())) << entry.path();
}

/// A body that has come whole.
class TextBody final : public http::BodyReader {
 public:
  void read(const std::function<void(std::string_view)>& take) override { take("v 0 0 0"); }
  void read_parts(const std::function<void(const http::Part&)>& start,
                  const std::function<void(std::string_view)>& take) override {
    start({.name = "mesh", .filename = {}});
    take("v 0 0 0");
    start({.name = "buffer", .filename = "a.bin"});
    take("0123");
  }
};

class Synchronising : public testing::Test {
 protected:
  void SetUp() override { noted_early.clear(); }
  void TearDown() override { EXPECT_THAT(noted_early, testing::IsEmpty()); }

  TempDir dir_;
};

TEST_F(Synchronising, AnUploadIsOnTheDiskBeforeItIsAJob) {
  for (const bool in_parts : {false, true}) {
    blobs::BlobStore blobs(dir_.path());
    const UploadFolder folder{.path = blobs.begin_upload("u")};
    TextBody body;
    const uploads::Upload upload =
        in_parts ? uploads::receive_parts(body, folder) : uploads::receive_asset(body, folder);
    const std::string job = in_parts ? "j_parts" : "j_whole";
    blobs.keep_upload("u", job, digests_of(upload.input));
    EXPECT_EQ(blobs.read(job, blobs::kDocumentFile), "v 0 0 0");
    EXPECT_EQ(blobs.digest(job, blobs::kDocumentFile), upload.input.sha256);
    expect_synced(blobs.path(job, ""));
    EXPECT_TRUE(is_synced(dir_.path() / "blobs"));
  }
}

TEST_F(Synchronising, ResultsAreOnTheDiskWhenTheyAreSealed) {
  blobs::BlobStore blobs(dir_.path());
  write_file(blobs.begin_upload("u") / blobs::kDocumentFile, "v 0 0 0");
  blobs.keep_upload("u", "j_1");
  blobs.write_unsealed("j_1", 1, blobs::kReportFile, "{}");
  for (const char* format : {"gltf", "obj", "json", "stl", "ply"})  // more than are synced at once
    blobs.write_unsealed("j_1", 1, blobs::result_file(format), format);
  blobs.write_unsealed("j_1", 1, blobs::result_file("glb"), std::string(3'000'000, 'x'));
  EXPECT_FALSE(is_synced(blobs.path("j_1", blobs::kReportFile)));  // or the next line tells nothing
  is_digests_turn = true;  // who does not wait for the others gives it its name too early
  blobs.seal("j_1", 1);
  expect_synced(blobs.path("j_1", ""));
  EXPECT_EQ(blobs::read_digests(blobs.path("j_1", "")).size(), 8U);
}

TEST_F(Synchronising, AFileWrittenByItselfIsOnTheDiskAtOnce) {
  blobs::BlobStore blobs(dir_.path());
  std::filesystem::create_directories(blobs.path("j_1", ""));
  ASSERT_TRUE(blobs.try_keep("j_1", std::string(blobs::kReportFile), "{}"));
  expect_synced(blobs.path("j_1", ""));
}

}  // namespace
}  // namespace unwrapd::server::store
