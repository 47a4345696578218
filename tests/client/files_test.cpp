#include "client/files.hpp"

#include <sys/stat.h>

#include <thread>

#include "tests/client/expect_failure.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

TEST(NewFile, HasItsNameOnlyWhenItIsWhole) {
  const TemporaryFolder folder;
  const auto path = folder.write("out.glb", "old");
  NewFile file(path);
  file.append("new, ");
  EXPECT_EQ(read_file(path), "old");
  file.append("whole");
  file.commit();
  EXPECT_EQ(read_file(path), "new, whole");
}

TEST(NewFile, LeavesNothingBehindWhenItIsGivenUp) {
  const TemporaryFolder folder;
  { NewFile(folder.file("out.glb")).append("half"); }
  EXPECT_EQ(folder.file_count(), 0);
}

TEST(NewFile, SaysWhichFileCannotBeWritten) {
  const TemporaryFolder folder;
  const auto path = folder.file("no/such/folder.glb");
  const std::string message = expect_failure(ExitCode::file, [&] { write_file(path, "x"); });
  EXPECT_NE(message.find("no/such/folder.glb"), std::string::npos);
}

TEST(NewFile, RefusesAFolderAtOnce) {
  const TemporaryFolder folder;
  const auto path = folder.file("out.glb");
  std::filesystem::create_directory(path);
  expect_failure(ExitCode::file, [&] { NewFile file(path); });
}

TEST(NewFile, ReplacesTheFileThatALinkLeadsTo) {
  const TemporaryFolder folder;
  const auto file = folder.write("own.glb", "old"), link = folder.file("link.glb");
  const auto far = folder.file("far.glb"), none = folder.file("none.glb");
  std::filesystem::create_symlink("own.glb", link);
  std::filesystem::create_symlink(link, far);
  std::filesystem::create_symlink("not_yet.glb", none);
  write_file(far, "new");
  write_file(none, "first");
  EXPECT_TRUE(std::filesystem::is_symlink(far));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(read_file(file), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(none));
  EXPECT_EQ(read_file(folder.file("not_yet.glb")), "first");
}

TEST(NewFile, WritesThroughAPipe) {
  const TemporaryFolder folder;
  const auto pipe = folder.file("out.glb");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string heard;
  {
    std::jthread reader([&] {
      std::ifstream stream(pipe, std::ios::binary);
      heard.assign(std::istreambuf_iterator<char>(stream), {});
    });
    write_file(pipe, "bytes");
  }
  EXPECT_EQ(heard, "bytes");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_EQ(folder.file_count(), 1);
}

TEST(NewFile, OfADashIsStandardOutput) {
  testing::internal::CaptureStdout();
  NewFile file("-");
  file.append("new, ");
  file.append("whole");
  file.commit();
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "new, whole");
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST(NewFile, WritesIntoAFileThatIsOpenByItsName) {
  const TemporaryFolder folder;
  const auto path = folder.write("log", "before, ");
  std::ofstream open(path, std::ios::app);
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    if (std::filesystem::read_symlink(entry, gone) == path) write_file(entry, "then");
  }
  EXPECT_EQ(read_file(path), "before, then");
}

}  // namespace
}  // namespace unwrapd::client
