#include "client/files_beside.hpp"

#include "client/unwrap_file.hpp"
#include "tests/client/expect_failure.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

std::string document(const std::string& uris) { return R"({"buffers":[)" + uris + "]}"; }

TEST(FilesBeside, AreFoundBesideTheDocumentUnderTheirUri) {
  const TemporaryFolder folder;
  folder.write("a.bin", "1");
  folder.write("data/b c.bin", "2");
  const auto gltf = folder.write(
      "mesh.gltf", document(R"({"uri":"a.bin"},{"uri":"data/b%20c.bin"},{"uri":"a.bin"})"));
  const auto buffers = files_beside(gltf, {});
  ASSERT_EQ(buffers.size(), 2);  // each once
  EXPECT_EQ(buffers[0].uri, "a.bin");
  EXPECT_EQ(buffers[0].file, folder.file("a.bin"));
  EXPECT_EQ(buffers[1].uri, "data/b%20c.bin");  // as the document writes it
  EXPECT_EQ(buffers[1].file, folder.file("data/b c.bin"));
}

TEST(FilesBeside, AreNotLookedForWhereThereAreNone) {
  const TemporaryFolder folder;
  for (const char* text :
       {R"({"buffers":[{"uri":"data:,x"},{"byteLength":4}]})", R"({"buffers":{"uri":"a"}})",
        R"({"buffers":[1,null,{"uri":2}]})", R"({})", R"([])", "no json"})
    EXPECT_TRUE(files_beside(folder.write("mesh.gltf", text), {.images = true}).empty()) << text;
  const auto obj = folder.write("mesh.obj", document(R"({"uri":"a"})"));
  EXPECT_TRUE(files_beside(obj, {.images = true}).empty());
}

TEST(FilesBeside, AreNeverTakenFromOutsideTheFolder) {
  const TemporaryFolder folder;
  folder.write("secret.bin", "x");
  for (const char* uri : {"../secret.bin", "/etc/hostname", "a/../../secret.bin",
                          "%2e%2e/secret.bin", "file:///etc/hostname", "https://host/a.bin"}) {
    const auto gltf =
        folder.write("inner/mesh.gltf", document(R"({"uri":")" + std::string(uri) + "\"}"));
    expect_failure(ExitCode::file, [&] { files_beside(gltf, {}); });
  }
}

TEST(FilesBeside, ImagesAreAmongThemIfAskedForAndThere) {
  const TemporaryFolder folder;
  folder.write("secret.png", "3");
  const auto gltf = folder.write(
      "in/mesh.gltf",
      R"({"images":[{"uri":"b.png"},{"uri":"gone.png"},{"uri":"../secret.png"},{"bufferView":0}]})");
  folder.write("in/b.png", "2");
  EXPECT_TRUE(files_beside(gltf, {}).empty());
  const auto files = files_beside(gltf, {.images = true});
  ASSERT_EQ(files.size(), 1);
  EXPECT_EQ(files[0].uri, "b.png");
}

TEST(FilesBeside, ImagesAreAskedForWhereTheResultContainsThem) {
  const auto wants_images = [](const OptionTexts& options) {
    Arguments arguments;
    arguments.options = options;
    return wanted_files(arguments).images;
  };
  EXPECT_TRUE(wants_images({{"output", "glb"}}));
  EXPECT_TRUE(wants_images({{"textures", "transfer"}}));
  EXPECT_FALSE(wants_images({{"output", "gltf"}}));
  EXPECT_FALSE(wants_images({}));
}

TEST(FilesBeside, ThatAreMissingAreNamed) {
  const TemporaryFolder folder;
  const auto gltf = folder.write("mesh.gltf", document(R"({"uri":"gone%zz.bin"})"));
  const std::string message = expect_failure(ExitCode::file, [&] { files_beside(gltf, {}); });
  EXPECT_NE(message.find("gone%zz.bin"), std::string::npos) << message;
}

std::vector<std::string> uris(const std::vector<FileBeside>& files) {
  std::vector<std::string> uris;
  for (const FileBeside& one : files) uris.push_back(one.uri);
  return uris;
}

TEST(FilesBeside, OfAnObjAreItsMaterialsAndTheirImages) {
  const TemporaryFolder folder;
  folder.write("a b.mtl",
               "newmtl m\n map_Kd -s 1 1 1 tex\\wood 1.png\r\nnorm gone.png\nKd 1 0 0\n");
  folder.write("c.mtl", "bump -bm .5 n.png\nmap_Kd tex/wood 1.png\nmap_Ke ../secret.png\n");
  folder.write("tex/wood 1.png", "1");
  folder.write("n.png", "2");
  const auto obj = folder.write(
      "mesh.obj",
      "# x\nmtllib a b.mtl\nmtllib c.mtl\nmtllib gone.mtl\nv 0 0 0\nf 1 1 1\nmtllib n.png\n");
  EXPECT_TRUE(files_beside(obj, {.images = true}).empty());
  EXPECT_EQ(uris(files_beside(obj, {.materials = true})),
            (std::vector<std::string>{"a b.mtl", "c.mtl", "tex/wood 1.png", "n.png"}));
}

}  // namespace
}  // namespace unwrapd::client
