// Files that were found whole are not read again until they are written.
#include "server/blobs/checked_files.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "server/base/identity.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::blobs {
namespace {

class CheckedFilesTest : public testing::Test {
 protected:
  /// Other bytes in the same file, last written at this second.
  void write(std::string_view bytes, std::int64_t second) {
    if (std::filesystem::exists(file_)) {  // in its place: the inode stays
      const int descriptor = ::open(file_.c_str(), O_WRONLY);
      EXPECT_EQ(::write(descriptor, bytes.data(), bytes.size()), std::ssize(bytes));
      ::close(descriptor);
    } else {
      write_file(file_, bytes);
    }
    set_time(second);
  }
  void set_time(std::int64_t second) {
    const timespec times[2] = {{.tv_sec = second, .tv_nsec = 0}, {.tv_sec = second, .tv_nsec = 0}};
    ASSERT_EQ(::utimensat(AT_FDCWD, file_.c_str(), times, 0), 0);
  }
  bool is_whole(std::string_view expected) {
    return checked_.is_whole(File::open(file_), sha256(expected));
  }

  TempDir dir_;
  std::filesystem::path file_ = dir_.path() / "file";
  CheckedFiles checked_{2};
};

TEST_F(CheckedFilesTest, AreReadOnceWhileTheyStayAsTheyAre) {
  write("good", 1000);
  EXPECT_TRUE(is_whole("good"));
  EXPECT_FALSE(is_whole("evil")) << "another digest is not the one that was found";
  write("evil", 1000);
  EXPECT_TRUE(is_whole("good")) << "it was read again";
  set_time(1001);
  EXPECT_FALSE(is_whole("good"));
  write("good", 1002);
  EXPECT_TRUE(is_whole("good")) << "what is mended is found so";
}

TEST_F(CheckedFilesTest, AreReadEachTimeWhileTheyMayBeWrittenUnseen) {
  write_file(file_, "good");
  EXPECT_TRUE(is_whole("good"));
  const FileStamp before = File::open(file_).stamp();
  write("evil", before.changed_ns / 1'000'000'000);
  const timespec times[2] = {
      {.tv_sec = before.changed_ns / 1'000'000'000, .tv_nsec = before.changed_ns % 1'000'000'000},
      {.tv_sec = before.changed_ns / 1'000'000'000, .tv_nsec = before.changed_ns % 1'000'000'000}};
  ASSERT_EQ(::utimensat(AT_FDCWD, file_.c_str(), times, 0), 0);
  ASSERT_EQ(File::open(file_).stamp(), before) << "as two writes within a tick of the clock";
  EXPECT_FALSE(is_whole("good"));
}

TEST_F(CheckedFilesTest, AreForgottenWhenThereAreMany) {
  write("good", 1000);
  EXPECT_TRUE(is_whole("good"));
  for (const std::int64_t second : {1001, 1002}) {
    set_time(second);
    EXPECT_TRUE(is_whole("good"));
  }
  write("evil", 1000);
  EXPECT_FALSE(is_whole("good"));
}

}  // namespace
}  // namespace unwrapd::server::blobs
