// Zip archives: one asset is found in them, and nothing else comes of them.
#include <gmock/gmock.h>
#include <zip.h>

#include <random>

#include "tests/asset/memory_guard.hpp"
#include "tests/asset/mesh_file_samples.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

using testing::HasSubstr;

struct Packed {
  std::string name, bytes;
  zip_int32_t method = ZIP_CM_DEFLATE;
  zip_uint32_t mode = 0100644;  ///< of the file in Unix
};

std::string zip_of(const std::vector<Packed>& files) {
  zip_source_t* source = zip_source_buffer_create(nullptr, 0, 0, nullptr);
  zip_source_keep(source);
  zip_t* zip = zip_open_from_source(source, ZIP_TRUNCATE, nullptr);
  for (const Packed& file : files) {
    zip_source_t* content = zip_source_buffer(zip, file.bytes.data(), file.bytes.size(), 0);
    const auto number = static_cast<zip_uint64_t>(zip_file_add(zip, file.name.c_str(), content, 0));
    EXPECT_EQ(zip_set_file_compression(zip, number, file.method, 9), 0);
    zip_file_set_external_attributes(zip, number, 0, ZIP_OPSYS_UNIX, file.mode << 16U);
  }
  EXPECT_EQ(zip_close(zip), 0);
  zip_source_open(source);
  zip_source_seek(source, 0, SEEK_END);
  std::string bytes(static_cast<std::size_t>(zip_source_tell(source)), '\0');
  zip_source_seek(source, 0, SEEK_SET);
  EXPECT_EQ(zip_source_read(source, bytes.data(), bytes.size()),
            static_cast<zip_int64_t>(bytes.size()));
  zip_source_close(source);
  zip_source_free(source);
  return bytes;
}

/// A square whose .gltf names its buffer by a URI.
std::vector<Packed> square_in_parts(const std::string& folder) {
  Builder b = square();
  b.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", "parts/the%20square.bin"}};
  return {{folder + "square.gltf", b.json.dump()}, {folder + "parts/the square.bin", b.bin}};
}

void expect_square(const std::string& archive) {
  const Asset asset = read_file(archive);
  EXPECT_EQ(asset.format(), Format::gltf);
  EXPECT_EQ(asset.surfaces()[0].mesh.face_count(), 2);
  EXPECT_EQ(read_naively(write(asset, split_everywhere(asset), Format::glb))[0].faces.size(), 2);
}

TEST(Zip, AGltfFindsItsPartsInItsFolder) {
  expect_square(zip_of(square_in_parts("")));
  std::vector<Packed> files = square_in_parts("a/model/");
  files.push_back({"a/model/", "", ZIP_CM_STORE, 040755});
  files.push_back({"__MACOSX/a/model/._square.gltf", "x"});
  files.push_back({"a/.DS_Store", "x"});
  files.push_back({"a/readme.txt", "by whom"});
  expect_square(zip_of(files));
}

TEST(Zip, AnyFormatMayBeInIt) {
  for (const auto& [name, file] :
       std::map<std::string, std::string>{{"a.GLB", square().glb()},
                                          {"b/a.stl", cube_stl()},
                                          {"a.ply", cube_text_ply()},
                                          {"a.off", cube_off()},
                                          {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}})
    for (const zip_int32_t method : {ZIP_CM_STORE, ZIP_CM_DEFLATE})
      EXPECT_EQ(read_file(zip_of({{name, file, method}, {"a.mtl", "newmtl a\n"}})).format(),
                read_file(file).format());
}

TEST(Zip, MissingPartsAreToldAsInAForm) {
  std::vector<Packed> files = square_in_parts("");
  files.pop_back();
  EXPECT_EQ(error_of(zip_of(files)).code(), ErrorCode::missing_buffer);
}

TEST(Zip, OneAssetIsExpected) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const auto& [files, message] : std::vector<std::pair<std::vector<Packed>, std::string>>{
           {{{"a.obj", obj}, {"b.obj", obj}}, "\"a.obj\" and \"b.obj\""},
           {{{"readme.txt", "none"}}, "without an asset"},
           {{{"inner.zip", zip_of({{"a.obj", obj}})}}, "without an asset"},
           {{{"a.obj", zip_of({{"a.obj", obj}})}}, "zip archive"},
           {{{"scene.usdc", "PXR-USDC"}}, "USDZ"},
           {{{"3D/3dmodel.model", "<model>"}}, "3MF"}}) {
    const Error error = error_of(zip_of(files));
    EXPECT_EQ(error.code(), ErrorCode::unknown_format) << message;
    EXPECT_THAT(error.what(), HasSubstr(message));
  }
}

TEST(Zip, ANameIsThereOnce) {
  std::vector<Packed> files = square_in_parts("");
  files.push_back({"parts/the other1.bin", std::string(files[1].bytes.size(), '\0')});
  for (const char* given : {"parts/the square.bin", "parts/the other1.bin"}) {
    std::string archive = zip_of(files);
    const std::string other = given == files[1].name ? files[2].name : files[1].name;
    for (std::size_t at = archive.find(other); at != std::string::npos; at = archive.find(other))
      archive.replace(at, other.size(), given);
    const Error error = error_of(archive);
    EXPECT_EQ(error.code(), ErrorCode::malformed_mesh);
    EXPECT_THAT(error.what(), HasSubstr("\"" + std::string(given) + "\" twice"));
  }
}

TEST(Zip, PathsThatLeadOutAreRefusedAndLinksIgnored) {
  for (const char* name : {"../a.bin", "/etc/a.bin", "b/../../a.bin", "b\\..\\a.bin", "c:a.bin"}) {
    std::vector<Packed> files = square_in_parts("");
    files.push_back({name, "x"});
    const Error error = error_of(zip_of(files));
    EXPECT_EQ(error.code(), ErrorCode::malformed_mesh) << name;
    EXPECT_THAT(error.what(), HasSubstr("leads out")) << name;
  }
  std::vector<Packed> files = square_in_parts("");
  files[1].mode = 0120777;
  EXPECT_EQ(error_of(zip_of(files)).code(), ErrorCode::missing_buffer);
}

TEST(Zip, BombsAreRefusedBeforeTheyInflate) {
  const std::string zeros(std::size_t{100} << 20, '\0');
  const std::string bomb = zip_of({{"a.obj", zeros}});
  EXPECT_LT(bomb.size(), std::size_t{1} << 20);
  const MemoryPeak peak;
  EXPECT_EQ(error_of(bomb, {.max_unzipped_bytes = 99 << 20}).code(), ErrorCode::body_too_large);
  EXPECT_LE(peak.bytes(), std::size_t{1} << 20);
  std::vector<Packed> files = square_in_parts("");
  for (int i = 0; i < 20; ++i)
    files.push_back({std::to_string(i) + ".bin", zeros.substr(0, 1 << 20)});
  EXPECT_EQ(error_of(zip_of(files), {.max_unzipped_bytes = 10 << 20}).code(),
            ErrorCode::body_too_large);
  EXPECT_NO_THROW(read({zip_of(files), {}}, {.max_unzipped_bytes = 21 << 20}));
  files.clear();
  for (int i = 0; i < 1001; ++i) files.push_back({std::to_string(i), ""});
  EXPECT_THAT(error_of(zip_of(files)).what(), HasSubstr("more than 1000 files"));
}

/// A directory that announces less than a file inflates to must not be believed.
TEST(Zip, AFileIsNoLongerThanAnnounced) {
  std::string archive = zip_of({{"a.stl", cube_stl()}});
  const std::string size = bytes(static_cast<std::uint32_t>(cube_stl().size()));
  for (std::size_t at = archive.find(size); at != std::string::npos; at = archive.find(size, at))
    archive.replace(at, 4, bytes(std::uint32_t{100}));
  EXPECT_EQ(error_of(archive).code(), ErrorCode::malformed_mesh);
}

TEST(Zip, BrokenArchivesAreReadOrRefused) {
  const std::string archive = zip_of(square_in_parts("a/"));
  const auto try_archive = [](const std::string& file) {
    const MemoryPeak peak;
    try {
      static_cast<void>(read({file, {}}, {.max_unzipped_bytes = 1 << 20}));
    } catch (const Error& error) {
      EXPECT_NE(error.code(), ErrorCode::internal);
    }
    EXPECT_LE(peak.bytes(), std::size_t{4} << 20);
  };
  for (std::size_t length = 0; length < archive.size(); ++length)
    EXPECT_THROW(read({archive.substr(0, length), {}}, {}), Error);
  std::mt19937 random(5);
  for (int k = 0; k < 5000; ++k) {
    std::string bad = archive;
    for (std::size_t cuts = 1 + random() % 4; cuts > 0; --cuts)
      bad[random() % bad.size()] = static_cast<char>(random());
    try_archive(bad);
  }
}

TEST(Zip, AnObjFindsItsMaterialsAndImages) {
  const std::string obj =
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";
  const std::string png = "\x89PNG\r\n\x1a\n" + std::string(80, '.');
  const std::vector<Packed> files = {{"x/a.obj", obj},
                                     {"x/tex/b.png", png},
                                     {"x/big.jpg", std::string(5000, 'x'), ZIP_CM_STORE},
                                     {"x/notes.txt", "no part of it"},
                                     {"x/a.mtl", "newmtl m\nmap_Kd tex/b.png\n"}};
  for (const std::size_t room : {std::size_t{1} << 20, obj.size() + 100}) {
    const Asset asset = read({zip_of(files), {}, {}}, {.max_unzipped_bytes = room}, kPlain);
    const Json json = json_of(write(asset, split_everywhere(asset), Format::glb));
    EXPECT_EQ(json["materials"][0]["name"], "m");
    ASSERT_TRUE(json.contains("images"));
    EXPECT_EQ(json["images"].size(), 1);
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
