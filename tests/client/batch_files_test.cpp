#include "client/batch_files.hpp"

#include <gmock/gmock.h>

#include <chrono>

#include "tests/client/expect_failure.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre, testing::HasSubstr;

std::vector<std::string> names(const std::vector<BatchFile>& items, fs::path BatchFile::*member,
                               const fs::path& base) {
  std::vector<std::string> all;
  for (const BatchFile& item : items) all.push_back((item.*member).lexically_relative(base));
  return all;
}

TEST(BatchFiles, AFolderIsItsMeshesByNameWithoutResultsAndOtherFiles) {
  const TemporaryFolder folder;
  for (const char* name : {"b.obj", "a.GLB", "sub/c.stl", "a.uv.GLB", "a.uv.0.1.GLB", "b.uv.1.obj",
                           "a.mtl", "notes.txt"})
    folder.write(name, "x");
  const fs::path base = folder.file("");
  const std::vector<fs::path> inputs{base};
  const auto beside = batch_files(inputs, "", "auto");
  EXPECT_THAT(names(beside, &BatchFile::file, base), ElementsAre("a.GLB", "b.obj", "sub/c.stl"));
  EXPECT_THAT(names(beside, &BatchFile::out, base),
              ElementsAre("a.uv.GLB", "b.uv.obj", "sub/c.uv.glb"));
  EXPECT_THAT(names(batch_files(inputs, "out", "auto"), &BatchFile::out, "out"),
              ElementsAre("a.GLB", "b.obj", "sub/c.glb"));
  folder.write("out/d.glb", "x");
  EXPECT_EQ(batch_files(inputs, folder.file("out"), "auto").size(), 3U);
  EXPECT_EQ(batch_files(inputs, "out", "auto").size(), 4U);
  fs::remove_all(folder.file("out"));
  EXPECT_THAT(names(batch_files(inputs, "out", "gltf"), &BatchFile::out, "out"),
              ElementsAre("a.gltf", "b.gltf", "sub/c.gltf"));
}

TEST(BatchFiles, APatternIsWhatItMatchesUnlessAFileHasThatName) {
  const TemporaryFolder folder;
  for (const char* name : {"a1.obj", "a2.obj", "b.obj", "[x].obj", "x.obj"})
    folder.write(name, "x");
  const auto found = [&](const char* pattern) {
    const std::vector<fs::path> inputs{folder.file(pattern)};
    return names(batch_files(inputs, "", "auto"), &BatchFile::file, folder.file(""));
  };
  EXPECT_THAT(found("a?.obj"), ElementsAre("a1.obj", "a2.obj"));
  EXPECT_THAT(found("[x].obj"), ElementsAre("[x].obj"));
  EXPECT_THAT(found("none*.obj"), ElementsAre("none*.obj"));
}

TEST(BatchFiles, TwoMeshesOfOneResultAreRefusedAndOneNamedTwiceIsOne) {
  const TemporaryFolder folder;
  for (const char* name : {"a/x.obj", "b/x.obj"}) folder.write(name, "x");
  const std::vector<fs::path> two{folder.file("a/x.obj"), folder.file("b/x.obj")};
  EXPECT_EQ(batch_files(two, "", "auto").size(), 2U);
  EXPECT_THAT(expect_failure(ExitCode::usage, [&] { batch_files(two, "out", "auto"); }),
              HasSubstr("would both become out/x.obj"));
  const std::vector<fs::path> twice{folder.file("a/x.obj"), folder.file("a"),
                                    folder.file("b/../a")};
  EXPECT_EQ(batch_files(twice, "", "auto").size(), 1U);
}

TEST(BatchFiles, NamesThatLeadNowhereAreLeftToTheJob) {
  const TemporaryFolder folder;
  const fs::path missing = folder.file("x.obj"), loop = folder.file("loop.obj");
  fs::create_symlink(loop, loop);
  const fs::path endless = std::string(5000, 'a') + ".obj";
  for (const fs::path& path : {missing, loop, endless}) {
    const std::vector<fs::path> twice{path, path};
    EXPECT_EQ(batch_files(twice, "", "auto").size(), 1U) << path;
  }
}

TEST(BatchFiles, AResultIsDoneUnlessItsMeshIsNewer) {
  const TemporaryFolder folder;
  const BatchFile item{folder.write("a.obj", "x"), folder.file("a.uv.obj")};
  EXPECT_FALSE(is_done(item));
  folder.write("a.uv.obj", "x");
  EXPECT_TRUE(is_done(item));
  fs::last_write_time(item.file, fs::last_write_time(item.out) + std::chrono::seconds(1));
  EXPECT_FALSE(is_done(item));
  EXPECT_FALSE(is_done({folder.file("gone.obj"), item.out}));
}

}  // namespace
}  // namespace unwrapd::client
