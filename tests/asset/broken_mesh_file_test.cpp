// STL, PLY and OFF that are cut off, lie about their size or are damaged.
#include <gmock/gmock.h>

#include <limits>
#include <random>
#include <vector>

#include "tests/asset/memory_guard.hpp"
#include "tests/asset/mesh_file_samples.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

using testing::HasSubstr;

TEST(Stl, BrokenFilesAreRefusedWithTheirPlace) {
  struct Case {
    std::string file, where, message;
    ErrorCode code = ErrorCode::malformed_mesh;
  };
  std::string infinite = cube_stl();
  infinite.replace(84 + 50 + 12, 4, bytes(std::numeric_limits<float>::infinity()));
  std::string longer = cube_stl("solid of an exporter") + "x";
  std::string none = cube_stl().substr(0, 80) + bytes(std::uint32_t{0});
  for (const Case& c : std::vector<Case>{
           {replaced(cube_text_stl(), "endfacet", "endface"), "line 8", "endfacet"},
           {replaced(cube_text_stl(), "vertex 0 1 0e0", "vertex 0 x 0"), "line 4", "\"x\" stands"},
           {replaced(cube_text_stl(), "endloop", "vertex 0 0 0"), "line 7", "endloop"},
           {"solid a\n", "line 2", "ends before"},
           {"solid a\nfacet normal 0 0 1 outer loop vertex 0 0 1e99", "line 2", "float",
            ErrorCode::non_finite_position},
           {"solid a\nendsolid\n", "", "no faces", ErrorCode::no_triangles},
           {longer, "byte 80", "announces 12"},
           {none, "", "no faces", ErrorCode::no_triangles},
           {infinite, "byte 146", "infinite", ErrorCode::non_finite_position}}) {
    const Error error = error_of(c.file);
    EXPECT_EQ(error.code(), c.code) << c.file.substr(0, 80);
    EXPECT_EQ(error.where(), c.where) << c.file.substr(0, 80);
    EXPECT_THAT(error.what(), HasSubstr(c.message));
  }
}

TEST(Ply, BrokenFilesAreRefusedWithTheirPlace) {
  const std::string text = cube_text_ply();
  struct Case {
    std::string from, to, where, message;
    ErrorCode code = ErrorCode::malformed_mesh;
  };
  for (const Case& c :
       std::vector<Case>{{"format ascii", "format utf8", "line 2", "ascii"},
                         {"format ascii 1.0\n", "", "line 18", "format"},
                         {"property float x", "property real x", "line 5", "type"},
                         {"property float x", "property float a", "line 20", "no x, y and z"},
                         {"element vertex 8\n", "", "line 4", "before the first element"},
                         {"comment", "remark", "line 3", "remark"},
                         {"end_header", "end", "line 19", "end"},
                         {"vertex 8", "vertex -8", "line 4", "whole number"},
                         {"vertex 8", "vertex 1e3", "line 4", "whole number"},
                         {"vertex 8", "vertex 999999999999999999", "line 20", "too short"},
                         {"face 6", "face 4000000000", "line 27", "too short"},
                         {"250000\n4 3 2 1 0", "250000\n-4 3 2 1 0", "line 28", "negative"},
                         {"4 3 2 1 0", "4 3 2 1 8", "line 34", "vertex 8"},
                         {"4 3 2 1 0", "4 3 2 1 -1", "line 28", "no number of a vertex"},
                         {"4 3 2 1 0", "4 3 2 1 .5", "line 28", "no number of a vertex"},
                         {"4 3 2 1 0", "999999999 3 2 1 0", "line 28", "more than the file holds"},
                         {"1 0 0 0 0 1", "1 0 inf 0 0 1", "line 21", "infinite",
                          ErrorCode::non_finite_position}}) {
    const Error error = error_of(replaced(text, c.from, c.to));
    EXPECT_EQ(error.code(), c.code) << c.to;
    EXPECT_EQ(error.where(), c.where) << c.to;
    EXPECT_THAT(error.what(), HasSubstr(c.message)) << c.to;
  }
}

TEST(Ply, BrokenStripsAreRefused) {
  EXPECT_THAT(error_of(strips_ply({0, 1, 2, -2}, true)).what(), HasSubstr("no number of a vertex"));
  EXPECT_THAT(error_of(strips_ply({0, 1, 8}, false)).what(), HasSubstr("vertex 8"));
  EXPECT_EQ(error_of(strips_ply({0, 1, -1, 2, 3, -1, 4, 4, 4}, true)).code(),
            ErrorCode::no_triangles);
}

TEST(Ply, StripsEndAtTheLimitOfFaces) {
  std::vector<int> corners;
  for (int k = 0; k < 300; ++k) corners.push_back(k % 8);
  const std::string file = strips_ply(corners, false);
  EXPECT_EQ(error_of(file, {.max_faces = 297}).code(), ErrorCode::too_many_faces);
  EXPECT_NO_THROW(read({file, {}}, {.max_faces = 298}));
}

TEST(Ply, APointCloudHasNoFaces) {
  const Error error = error_of(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n0 0 0\n");
  EXPECT_EQ(error.code(), ErrorCode::no_triangles);
}

TEST(Off, BrokenFilesAreRefusedWithTheirPlace) {
  struct Case {
    std::string from, to, where, message;
  };
  for (const Case& c : std::vector<Case>{{"8 6 12", "8 6000 12", "line 2", "too short"},
                                         {"8 6 12", "999999999999 6 12", "line 2", "too short"},
                                         {"8 6 12", "BINARY", "line 2", "BINARY"},
                                         {"OFF", "4OFF", "line 1", "three dimensions"},
                                         {"\n1 1 0\n", "\n1 1 zero\n", "line 6", "\"zero\" stands"},
                                         {"4 3 2 1 0", "4 3 2 1 8", "line 12", "from 0 to 7"},
                                         {"4 3 2 1 0", "4 3 2 1 -1", "line 12", "from 0 to 7"}}) {
    const Error error = error_of(replaced(cube_off(), c.from, c.to));
    EXPECT_EQ(error.code(), ErrorCode::malformed_mesh) << c.to;
    EXPECT_EQ(error.where(), c.where) << c.to;
    EXPECT_THAT(error.what(), HasSubstr(c.message)) << c.to;
  }
}

/// The same within a few megabytes.
void try_mesh_file(const std::string& file) {
  const MemoryPeak peak;
  try_file(file);
  EXPECT_LE(peak.bytes(), std::size_t{4} << 20) << file.size();
}

TEST(MeshFile, EveryPrefixIsReadOrRefused) {
  for (const auto& [name, file] : cubes()) {
    SCOPED_TRACE(name);
    for (std::size_t length = 0; length < file.size(); ++length)
      try_mesh_file(file.substr(0, length));
  }
}

TEST(MeshFile, NoPrefixOfATextStlOrAPlyIsRead) {
  for (const std::string& file : {cube_stl(), cube_text_stl(), cube_binary_ply(true)})
    for (std::size_t length = 0; length + 16 < file.size(); ++length)
      EXPECT_THROW(read({file.substr(0, length), {}}, {}), Error) << length;
}

TEST(MeshFile, DamagedFilesAreReadOrRefused) {
  std::mt19937 random(4);
  for (const auto& [name, file] : cubes()) {
    SCOPED_TRACE(name);
    for (int k = 0; k < 1000; ++k) {
      std::string bad = file;
      for (std::size_t cuts = 1 + random() % 4; cuts > 0; --cuts) {
        const std::size_t at = random() % bad.size();
        if (random() % 2 == 0) {
          bad[at] = static_cast<char>(random());
        } else if (random() % 2 == 0) {
          bad[at] = "0123456789-+.e \n"[random() % 16];
        } else {
          bad.insert(at, bad.substr(random() % bad.size(), random() % 8));
        }
      }
      try_mesh_file(bad);
    }
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
