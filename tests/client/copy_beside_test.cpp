// The files that a result refers to, in a folder other than that of its input.
#include "client/copy_beside.hpp"

#include <gmock/gmock.h>

#include "client/files.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre, testing::HasSubstr, testing::IsEmpty;

class CopyBeside : public testing::Test {
 protected:
  /// After in/NAME has become out/NAME, with the same text.
  std::vector<std::string> copied(const std::string& name, const std::string& text) {
    arguments_.file = folder_.write("in/" + name, text);
    arguments_.out = folder_.write("out/" + name, text);
    return copy_beside(arguments_);
  }

  [[nodiscard]] bool exists(const char* name) const { return fs::exists(folder_.file(name)); }

  const TemporaryFolder folder_;
  Arguments arguments_;
};

TEST_F(CopyBeside, ImagesOfAGltfFollowTheResult) {
  folder_.write("in/a b.png", "1");
  folder_.write("in/tex/c.png", "2");
  EXPECT_THAT(copied("t.gltf", R"({"images":[{"uri":"a%20b.png"},{"uri":"tex/c.png"},)"
                               R"({"uri":"data:,x"},{"uri":"https://a.b/d.png"}]})"),
              IsEmpty());
  EXPECT_EQ(read_file(folder_.file("out/a b.png")), "1");
  EXPECT_EQ(read_file(folder_.file("out/tex/c.png")), "2");
}

TEST_F(CopyBeside, MaterialsOfAnObjFollowTheResult) {
  folder_.write("in/m.mtl", "newmtl a\nmap_Kd tex/a%20b.png\n");
  folder_.write("in/tex/a%20b.png", "1");
  EXPECT_THAT(copied("t.obj", "mtllib m.mtl\nv 0 0 0\n"), IsEmpty());
  EXPECT_TRUE(exists("out/m.mtl"));
  EXPECT_TRUE(exists("out/tex/a%20b.png"));
}

TEST_F(CopyBeside, AFileThatIsThereStays) {
  folder_.write("in/a.png", "1");
  folder_.write("in/b.png", "2");
  folder_.write("out/a.png", "1");
  folder_.write("out/b.png", "3");
  EXPECT_THAT(copied("t.gltf", R"({"images":[{"uri":"a.png"},{"uri":"b.png"}]})"),
              ElementsAre(HasSubstr("were not replaced: b.png")));
  EXPECT_EQ(read_file(folder_.file("out/b.png")), "3");
}

TEST_F(CopyBeside, WhatCannotBeCopiedIsNamed) {
  folder_.write("secret.png", "1");
  fs::create_directories(folder_.file("out"));
  fs::create_directory_symlink(folder_.file(""), folder_.file("out/link"));
  folder_.write("in/link/b.png", "2");
  EXPECT_THAT(
      copied("t.gltf",
             R"({"images":[{"uri":"gone.png"},{"uri":"../secret.png"},{"uri":"link/b.png"}]})"),
      ElementsAre(HasSubstr("put them beside the result: gone.png, ../secret.png, link/b.png")));
  EXPECT_FALSE(exists("b.png"));
}

TEST_F(CopyBeside, OtherResultsNeedNothing) {
  folder_.write("in/a.png", "1");
  const std::string text = R"({"images":[{"uri":"a.png"}]})";
  arguments_.options["output"] = "glb";
  EXPECT_THAT(copied("t.gltf", text), IsEmpty());
  arguments_.options["output"] = "obj";
  EXPECT_THAT(copied("t.gltf", text), IsEmpty());
  EXPECT_FALSE(exists("out/a.png"));
  arguments_.options.clear();
  arguments_.out = folder_.write("in/t.uv.gltf", R"({"images":[{"uri":"gone.png"}]})");
  EXPECT_THAT(copy_beside(arguments_), IsEmpty());  // beside its input
}

}  // namespace
}  // namespace unwrapd::client
