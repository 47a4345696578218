#include "client/upload.hpp"

#include <gmock/gmock.h>

#include "tests/client/expect_failure.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

using testing::HasSubstr;

std::string read_all(const Upload& upload, std::size_t block) {
  UploadReader reader(upload);
  std::string bytes, buffer(block, '\0');
  while (const std::size_t count = reader.read(buffer.data(), block))
    bytes.append(buffer, 0, count);
  return bytes;
}

TEST(Upload, SendsTheBytesOfTheFile) {
  const TemporaryFolder folder;
  std::string bytes(200'000, 'x');
  bytes[77'777] = '\0';
  const Upload upload = raw_upload(folder.write("mesh.glb", bytes));
  EXPECT_EQ(upload.content_type, "model/gltf-binary");
  EXPECT_EQ(upload.bytes(), bytes.size());
  EXPECT_EQ(read_all(upload, 65'536), bytes);
}

TEST(Upload, NamesTheMediaTypeOfEveryFormat) {
  EXPECT_EQ(media_type("a.gltf"), "model/gltf+json");
  EXPECT_EQ(media_type("a.obj"), "model/obj");
  EXPECT_EQ(media_type("a.stl"), "model/stl");
  EXPECT_EQ(media_type("a.ply"), "model/ply");
  EXPECT_EQ(media_type("a.off"), "model/off");
  EXPECT_EQ(media_type("a.zip"), "application/zip");
  EXPECT_EQ(media_type("a.glb.txt"), "application/octet-stream");
}

TEST(Upload, PutsOptionsDocumentAndBuffersIntoParts) {
  const TemporaryFolder folder;
  const auto gltf = folder.write("mesh.gltf", "{document}");
  const auto buffer = folder.write("a \"b\".bin", "BUFFER");
  const Upload upload = multipart_upload(R"({"method":"asap"})", gltf, {{"a%20\"b\".bin", buffer}});
  for (const std::size_t block : {1, 7, 100'000}) {
    const std::string body = read_all(upload, block);
    EXPECT_EQ(body.size(), upload.bytes());
    EXPECT_THAT(body, HasSubstr("name=\"options\"\r\nContent-Type: application/json\r\n\r\n"
                                "{\"method\":\"asap\"}\r\n--"));
    EXPECT_THAT(body, HasSubstr("name=\"mesh\"; filename=\"mesh.gltf\"\r\n"
                                "Content-Type: model/gltf+json\r\n\r\n{document}\r\n--"));
    EXPECT_THAT(body, HasSubstr("name=\"buffer\"; filename=\"a%20%22b%22.bin\"\r\n"));
    EXPECT_THAT(body, HasSubstr("\r\n\r\nBUFFER\r\n--"));
    EXPECT_TRUE(body.ends_with("--\r\n"));
  }
}

TEST(Upload, FailsWhenAFileShrinksMeanwhile) {
  const TemporaryFolder folder;
  const auto path = folder.write("mesh.obj", "0123456789");
  const Upload upload = raw_upload(path);
  folder.write("mesh.obj", "01234");
  expect_failure(ExitCode::file, [&] { read_all(upload, 4); });
}

TEST(Upload, FailsForAFileThatIsNotThere) {
  expect_failure(ExitCode::file, [] { raw_upload("no/such/mesh.obj"); });
  expect_failure(ExitCode::file, [] { raw_upload("/"); });
}

}  // namespace
}  // namespace unwrapd::client
