#include "client/files.hpp"

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

}  // namespace
}  // namespace unwrapd::client
