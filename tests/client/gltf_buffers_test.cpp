#include "client/gltf_buffers.hpp"

#include "tests/client/expect_failure.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

std::string document(const std::string& uris) { return R"({"buffers":[)" + uris + "]}"; }

TEST(ExternalBuffers, AreFoundBesideTheDocumentUnderTheirUri) {
  const TemporaryFolder folder;
  folder.write("a.bin", "1");
  folder.write("data/b c.bin", "2");
  const auto gltf = folder.write(
      "mesh.gltf", document(R"({"uri":"a.bin"},{"uri":"data/b%20c.bin"},{"uri":"a.bin"})"));
  const auto buffers = external_buffers(gltf, false);
  ASSERT_EQ(buffers.size(), 2);  // each once
  EXPECT_EQ(buffers[0].uri, "a.bin");
  EXPECT_EQ(buffers[0].file, folder.file("a.bin"));
  EXPECT_EQ(buffers[1].uri, "data/b%20c.bin");  // as the document writes it
  EXPECT_EQ(buffers[1].file, folder.file("data/b c.bin"));
}

TEST(ExternalBuffers, AreNotLookedForWhereThereAreNone) {
  const TemporaryFolder folder;
  for (const char* text :
       {R"({"buffers":[{"uri":"data:,x"},{"byteLength":4}]})", R"({"buffers":{"uri":"a"}})",
        R"({"buffers":[1,null,{"uri":2}]})", R"({})", R"([])", "no json"})
    EXPECT_TRUE(external_buffers(folder.write("mesh.gltf", text), true).empty()) << text;
  const auto obj = folder.write("mesh.obj", document(R"({"uri":"a"})"));
  EXPECT_TRUE(external_buffers(obj, true).empty());
}

TEST(ExternalBuffers, AreNeverTakenFromOutsideTheFolder) {
  const TemporaryFolder folder;
  folder.write("secret.bin", "x");
  for (const char* uri : {"../secret.bin", "/etc/hostname", "a/../../secret.bin",
                          "%2e%2e/secret.bin", "file:///etc/hostname", "https://host/a.bin"}) {
    const auto gltf =
        folder.write("inner/mesh.gltf", document(R"({"uri":")" + std::string(uri) + "\"}"));
    expect_failure(ExitCode::file, [&] { external_buffers(gltf, false); });
  }
}

TEST(ExternalBuffers, ImagesAreAmongThemIfAskedForAndThere) {
  const TemporaryFolder folder;
  folder.write("secret.png", "3");
  const auto gltf = folder.write(
      "in/mesh.gltf",
      R"({"images":[{"uri":"b.png"},{"uri":"gone.png"},{"uri":"../secret.png"},{"bufferView":0}]})");
  folder.write("in/b.png", "2");
  EXPECT_TRUE(external_buffers(gltf, false).empty());
  const auto files = external_buffers(gltf, true);
  ASSERT_EQ(files.size(), 1);
  EXPECT_EQ(files[0].uri, "b.png");
}

TEST(ExternalBuffers, ThatAreMissingAreNamed) {
  const TemporaryFolder folder;
  const auto gltf = folder.write("mesh.gltf", document(R"({"uri":"gone%zz.bin"})"));
  const std::string message =
      expect_failure(ExitCode::file, [&] { external_buffers(gltf, false); });
  EXPECT_NE(message.find("gone%zz.bin"), std::string::npos) << message;
}

}  // namespace
}  // namespace unwrapd::client
