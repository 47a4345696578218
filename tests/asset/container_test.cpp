#include <gmock/gmock.h>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

TEST(Recognition, GoesByContent) {
  EXPECT_EQ(read_file(square().glb()).format(), Format::glb);
  EXPECT_EQ(read_file(square().gltf()).format(), Format::gltf);
  EXPECT_EQ(read_file("\xef\xbb\xbf" + square().gltf()).format(), Format::gltf);
  EXPECT_EQ(read_file("# a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").format(), Format::obj);
}

std::string many(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

/// Exporters write long licences, histories and settings before the geometry.
TEST(Recognition, ReadsAnObjAfterAnyLengthOfCommentsAndEmptyLines) {
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const std::string& before :
       {many("# exported by a program that has much to say\n", 50'000),
        "#" + std::string(3'000'000, 'x') + "\n", std::string(200'000, '\n'),
        many("# of an old Mac\r", 20'000), many("# a\r\n \t\r\n", 20'000),
        "\xef\xbb\xbf" + many("#\n", 100'000), many("vt 0.25 0.5\n", 20'000),
        many("vn 0 0 1\n", 20'000), std::string("mtllib a.mtl\no x\ng y\ns off\n"),
        std::string("f 1 3 2\n") + many("vt .5 .5\n", 20'000)})
    EXPECT_EQ(read_file(before + mesh).format(), Format::obj) << before.substr(0, 50);
}

TEST(Recognition, ReadsGltfAfterAnyLengthOfSpace) {
  const std::string spaces = many(" \t\r\n", 100'000);
  EXPECT_EQ(read_file(spaces + square().gltf()).format(), Format::gltf);
  EXPECT_EQ(read_file("\xef\xbb\xbf" + spaces + square().gltf()).format(), Format::gltf);
}

TEST(Recognition, TakesNoProseForAnObj) {
  for (const std::string& file :
       {many("# a remark\n", 200'000), many("p. 7 of a book\n", 200'000),
        many("f is a function\n", 200'000), std::string(1'000'000, ' '),
        many("word\n", 200'000) + "v 0 0 0\n", std::string("v"), std::string("f\n1 2 3\n")})
    EXPECT_EQ(error_of(file).code(), ErrorCode::unknown_format) << file.substr(0, 50);
}

TEST(Recognition, TellsOtherFormatsByNameAndHowToConvertThem) {
  struct Case {
    std::string file, name, advice;
  };
  for (const Case& c : std::vector<Case>{
           {std::string("Kaydara FBX Binary  \0", 21), "FBX", "FBX2glTF"},
           {"; FBX 7.4.0 project file\n", "FBX", "FBX2glTF"},
           {"PXR-USDC\1", "USD", "usd2gltf"},
           {"#usda 1.0\n", "USD", "usd2gltf"},
           {"BLENDER-v300", "BLEND", "Export"},
           {"\xef\xbb\xbf<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"\">", "Collada", "Blender"},
           {"<?xml version=\"1.0\"?>\n<amf>", "AMF", "Blender"},
           {"#VRML V2.0 utf8\n", "VRML", "Blender"},
           {"ISO-10303-21;\n", "STEP", "CAD"},
           {std::string("\xff\xfev\0 \0", 6), "UTF-16", "UTF-8"},
           {std::string("\xfe\xff\0v\0 ", 6), "UTF-16", "UTF-8"}}) {
    const Error error = error_of(c.file);
    EXPECT_EQ(error.code(), ErrorCode::unknown_format);
    EXPECT_THAT(error.what(), testing::HasSubstr(c.name));
    EXPECT_THAT(error.what(), testing::HasSubstr(c.advice));
  }
}

TEST(Recognition, RefusesWhatItKnowsToBeSomethingElse) {
  for (const std::string& file :
       {std::string("DRACO\2\2\1\1"), std::string("\x1f\x8b\x08"), std::string(),
        std::string("null"), std::string("[1]"), std::string("hello"), std::string("v 0 0 0\0", 8)})
    EXPECT_EQ(error_of(file).code(), ErrorCode::unknown_format) << file;
}

TEST(Glb, EveryPrefixIsRefused) {
  const std::string file = square().glb();
  for (std::size_t length = 4; length < file.size(); ++length)
    EXPECT_EQ(error_of(file.substr(0, length)).code(), ErrorCode::malformed_glb) << length;
}

TEST(Glb, EveryWrongHeaderWordIsRefusedAtItsByte) {
  for (const std::size_t byte : {std::size_t{4}, std::size_t{8}, std::size_t{12}}) {
    std::string file = square().glb();
    file[byte + 3] = '\x7f';
    const Error error = error_of(file);
    EXPECT_EQ(error.code(), ErrorCode::malformed_glb);
    EXPECT_EQ(error.where(), "byte " + std::to_string(byte));
  }
}

TEST(Glb, KeepsTheChunksThatItDoesNotKnow) {
  std::string file = square().glb();
  const std::string extra("\x04\0\0\0WHATabcd", 12);
  file += extra;
  file[8] = static_cast<char>(file.size() & 0xff);
  file[9] = static_cast<char>(file.size() >> 8);
  const Asset asset = read_file(file);
  EXPECT_TRUE(write(asset, split_nowhere(asset), Format::glb).ends_with(extra));
}

void append_word(std::string& file, std::size_t word) {
  for (int k = 0; k < 4; ++k) file += static_cast<char>(word >> (8 * k) & 0xff);
}

/// The square's GLB, its chunks `extra` bytes longer than a multiple of 4, with padding behind them
/// that their lengths do not tell of, or none.
std::string unaligned_glb(std::size_t extra, bool is_padded) {
  Builder b = square();
  std::string json = json_of(b.glb()).dump();
  while (json.size() % 4 != extra) json += ' ';
  while (b.bin.size() % 4 != extra) b.bin += 'x';
  std::string chunks;
  for (const auto& [type, bytes] : {std::pair("JSON", json), std::pair("BIN\0", b.bin)}) {
    append_word(chunks, bytes.size());
    chunks.append(type, 4);
    chunks += bytes + std::string(is_padded ? 4 - extra : 0, ' ');
  }
  std::string file = "glTF";
  append_word(file, 2);
  append_word(file, 12 + chunks.size());
  return file + chunks;
}

TEST(Glb, ChunksOfAnyLengthAreReadAndTold) {
  const Asset expected = read_file(square().glb());
  EXPECT_TRUE(expected.repairs().empty());
  for (const std::size_t extra : {1, 2, 3})
    for (const bool is_padded : {false, true}) {
      SCOPED_TRACE(std::to_string(extra) + (is_padded ? " padded" : ""));
      const std::string file = unaligned_glb(extra, is_padded);
      const Asset asset = read_file(file);
      ASSERT_EQ(asset.repairs().size(), 1U);
      EXPECT_EQ(asset.repairs()[0].kind, FileRepairKind::chunks_padded);
      EXPECT_EQ(asset.repairs()[0].count, 2);
      EXPECT_EQ(asset.surfaces()[0].mesh.positions, expected.surfaces()[0].mesh.positions);
      const std::string answer = write(asset, split_nowhere(asset), Format::glb);
      EXPECT_TRUE(read_file(answer).repairs().empty());
      for (std::size_t length = 4; length < file.size(); ++length)
        EXPECT_EQ(error_of(file.substr(0, length)).code(), ErrorCode::malformed_glb) << length;
    }
}

TEST(Json, DepthIsBoundedWithoutRecursion) {
  const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
  const std::string file = R"({"asset":{"version":"2.0"},"extras":)" + deep + "}";
  EXPECT_EQ(error_of(file).code(), ErrorCode::malformed_json);
  EXPECT_EQ(error_of(glb_of(file, "")).code(), ErrorCode::malformed_json);
}

TEST(Json, RefusesDuplicateNamesBadTextAndNumbersBeyondADouble) {
  std::string many = "{";
  for (int i = 0; i < 100; ++i) many += "\"" + std::to_string(i) + "\":0,";
  for (const std::string& file : {std::string(R"({"a":1,"a":2})"), many + R"("42":0})",
                                  std::string(R"({"a":)"), std::string("{\"a\":\"\xff\"}"),
                                  std::string(R"({"a":1e400})"), std::string(R"({"a":1} x)")})
    EXPECT_EQ(error_of(file).code(), ErrorCode::malformed_json) << file;
}

TEST(Uri, OnlyPlainRelativeNamesAreLookedUp) {
  const std::string bin = square().bin;
  for (const std::string uri :
       {"../a.bin", "a/../../b.bin", "/etc/passwd", "file:///etc/passwd", "http://127.0.0.1/x",
        "C:\\x.bin", "\\\\evil\\x", "..%2fa.bin", "%2fetc%2fpasswd", "a%00.bin", "a%5cb.bin", ""}) {
    Builder b = square();
    b.json["buffers"][0] = {{"byteLength", bin.size()}, {"uri", uri}};
    const std::string document = b.json.dump();
    try {
      read({document, {{uri, bin}}}, {});
      ADD_FAILURE() << uri;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::external_uri) << uri;
      EXPECT_EQ(error.where(), "/buffers/0/uri");
    }
  }
}

TEST(Uri, ABufferIsFoundByItsNameAsWrittenOrDecoded) {
  Builder b = square();
  b.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", "my%20data/a.bin"}};
  const std::string document = b.json.dump();
  EXPECT_EQ(error_of(document).code(), ErrorCode::missing_buffer);
  for (const char* name : {"my%20data/a.bin", "my data/a.bin"})
    EXPECT_EQ(read({document, {{name, b.bin}}}, {}).surfaces().size(), 1U) << name;
}

TEST(Uri, AShortOrBrokenBufferIsRefused) {
  Builder b = square();
  for (const char* uri : {"data:application/octet-stream;base64,AAAA", "data:;base64,****",
                          "data:application/octet-stream,AAAA", "data:"}) {
    b.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", uri}};
    EXPECT_EQ(error_of(b.json.dump()).code(), ErrorCode::malformed_gltf) << uri;
  }
}

TEST(Uri, DataMayBePercentEncoded) {
  Builder b = square();
  std::string text = "data:application/gltf-buffer,";
  for (const char c : b.bin) {
    constexpr std::string_view digits = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(c);
    text += {'%', digits[byte >> 4], digits[byte & 15]};
  }
  b.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", text}};
  EXPECT_EQ(read_file(b.json.dump()).surfaces()[0].mesh.positions,
            read_file(square().glb()).surfaces()[0].mesh.positions);
}

TEST(Uri, ThoseOfImagesDoNotMatter) {
  Builder b = square();
  b.json["images"] = {{{"uri", "../../../etc/passwd"}}, {{"uri", "http://169.254.169.254/"}}};
  EXPECT_EQ(read_file(b.gltf()).surfaces().size(), 1U);
}

}  // namespace
}  // namespace unwrapd::asset::test
