// STL, PLY and OFF: one cube in seven encodings, and what the answers keep of it.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "tests/asset/mesh_file_samples.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

using testing::HasSubstr;

/// Six times the volume that the faces enclose: the cube's is 6 if they point outwards.
double volume(const TriMesh& mesh) {
  double sum = 0;
  for (const Triangle& face : mesh.faces) {
    const auto at = [&](std::size_t k) {
      return mesh.positions[static_cast<std::size_t>(face[k])];
    };
    sum += at(0).dot(at(1).cross(at(2)));
  }
  return sum;
}

std::string all_notes(const Asset& asset, Format output) {
  std::string text;
  for (const Note& note : side_effects(asset, split_everywhere(asset), output))
    text += note.text + "\n";
  return text;
}

TEST(MeshFile, EveryEncodingOfACubeIsTheCube) {
  for (const auto& [name, file] : cubes()) {
    SCOPED_TRACE(name);
    const Asset asset = read_file(file);
    ASSERT_EQ(asset.surfaces().size(), 1);
    const Surface& surface = asset.surfaces()[0];
    EXPECT_EQ(surface.mesh.vertex_count(), 8);
    EXPECT_EQ(surface.mesh.face_count(), 12);
    EXPECT_EQ(surface.part, std::vector<Index>(12, 0));
    EXPECT_EQ(surface.name, format_name(asset.format()));
    EXPECT_DOUBLE_EQ(volume(surface.mesh), 6);
  }
}

TEST(MeshFile, AnswersHaveTheFacesAndTheNewUvs) {
  for (const auto& [name, file] : cubes()) {
    SCOPED_TRACE(name);
    const Asset asset = read_file(file);
    EXPECT_EQ(usual_output(asset.format()), Format::glb);
    const std::vector<UnwrappedSurface> unwrapped = split_everywhere(asset);
    for (const Format output : {Format::glb, Format::gltf}) {
      const std::vector<ReadPrimitive> answer = read_naively(write(asset, unwrapped, output));
      ASSERT_EQ(answer.size(), 1);
      ASSERT_EQ(answer[0].faces.size(), 12);
      for (const Face& face : answer[0].faces)
        for (int k = 0; k < 3; ++k) {
          const auto uv = uv_of(points_of(face), k);
          EXPECT_NEAR(face.at("TEXCOORD_0")[static_cast<std::size_t>(k)][0], uv[0], 1e-6);
          EXPECT_NEAR(face.at("TEXCOORD_0")[static_cast<std::size_t>(k)][1], 1 - uv[1], 1e-6);
        }
    }
    const Asset obj = read_file(write(asset, unwrapped, Format::obj));
    EXPECT_EQ(obj.surfaces()[0].mesh.faces, asset.surfaces()[0].mesh.faces);
    EXPECT_EQ(obj.surfaces()[0].mesh.positions, asset.surfaces()[0].mesh.positions);
  }
}

TEST(MeshFile, VertexMapsNameTheVerticesOfTheFile) {
  for (const auto& [name, file] : cubes()) {
    SCOPED_TRACE(name);
    const Asset asset = read_file(file);
    const std::vector<UnwrappedSurface> unwrapped = split_everywhere(asset);
    const std::vector<VertexMap> maps = vertex_maps(asset, unwrapped, Format::glb);
    ASSERT_EQ(maps.size(), 1);
    EXPECT_EQ(maps[0].kept, 0);
    EXPECT_EQ(maps[0].copies.size(), 36);
    EXPECT_EQ(*std::ranges::max_element(maps[0].copies), 7);
    EXPECT_EQ(vertex_maps(asset, unwrapped, Format::obj)[0].kept, 8);
  }
}

TEST(MeshFile, CompressedAnswersAreReadAgain) {
  for (const Compression compression : {Compression::draco, Compression::meshopt}) {
    const Asset asset = read_file(cube_stl(), {.compression = compression});
    const std::string answer = write(asset, split_everywhere(asset), Format::glb);
    EXPECT_DOUBLE_EQ(volume(read_file(answer).surfaces()[0].mesh), 6);
  }
}

TEST(MeshFile, NotesTellWhatTheAnswerLacks) {
  EXPECT_THAT(all_notes(read_file(cube_stl()), Format::glb), HasSubstr("The input is STL"));
  const std::string ply = all_notes(read_file(cube_binary_ply(true)), Format::glb);
  EXPECT_THAT(ply, HasSubstr("6 faces have more than three corners"));
  EXPECT_THAT(ply, HasSubstr("vertex red, face w, element edge"));
  std::string painted = cube_stl();
  painted[84 + 48] = 1;
  EXPECT_THAT(all_notes(read_file(painted), Format::glb), HasSubstr("attribute bytes"));
}

TEST(MeshFile, OptionsOfAGltfAreRefused) {
  for (const AssetOptions& options : {AssetOptions{.texcoord = 1}, AssetOptions{.materials = {"a"}},
                                      AssetOptions{.primitives = {"/meshes/0/primitives/0"}}})
    EXPECT_THROW(read_file(cube_stl(), options), Error);
}

TEST(MeshFile, LimitsHold) {
  for (const auto& [name, file] : cubes()) {
    SCOPED_TRACE(name);
    EXPECT_EQ(error_of(file, {.max_vertices = 7}).code(), ErrorCode::too_many_vertices);
    EXPECT_EQ(error_of(file, {.max_faces = 11}).code(), ErrorCode::too_many_faces);
    EXPECT_NO_THROW(read({file, {}}, {.max_vertices = 8, .max_faces = 12}));
  }
}

TEST(MeshFile, ACancelledJobStopsReading) {
  std::stop_source stop;
  stop.request_stop();
  for (const auto& [name, file] : cubes()) {
    SCOPED_TRACE(name);
    try {
      read({file, {}, stop.get_token()}, {});
      ADD_FAILURE() << "read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
  }
}

TEST(Stl, KeywordsMayHaveAnyCaseAndNormalsAnyValue) {
  std::string file = cube_text_stl();
  std::ranges::transform(file, file.begin(), [](unsigned char c) { return std::toupper(c); });
  EXPECT_EQ(read_file(file).surfaces()[0].mesh.face_count(), 12);
  file = replaced(cube_text_stl(), "normal 0 0 1", "normal nan -nan(ind) inf");
  EXPECT_EQ(read_file(file).surfaces()[0].mesh.face_count(), 12);
}

TEST(Stl, AllSolidsAreRead) {
  const Asset asset = read_file(cube_text_stl() + "\n" + cube_text_stl());
  EXPECT_EQ(asset.surfaces()[0].mesh.face_count(), 24);
}

TEST(Ply, TextureCoordinatesOfVerticesAreRead) {
  for (const char* names : {"s t", "u v", "texture_u texture_v", "texture_s texture_t"}) {
    const std::string u(names, std::string_view(names).find(' '));
    const std::string v(names + u.size() + 1);
    std::string file =
        replaced(cube_binary_ply(true), "property float s\n", "property float " + u + "\n");
    file = replaced(file, "property float t\n", "property float " + v + "\n");
    Asset asset = read_file(file);
    read_uvs(asset);
    const Surface& surface = asset.surfaces()[0];
    ASSERT_EQ(surface.corner_uv.size(), 12) << names;
    for (std::size_t t = 0; t < 12; ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& p = surface.mesh.positions[static_cast<std::size_t>(surface.mesh.faces[t][k])];
        EXPECT_EQ(surface.corner_uv[t][k], Vec2(p.x() / 2, p.y() / 4));
      }
  }
}

/// The triangles, each from its lowest corner on.
std::set<std::array<Index, 3>> turned_triangles(const TriMesh& mesh) {
  std::set<std::array<Index, 3>> all;
  for (const Triangle& face : mesh.faces) {
    std::array<Index, 3> corners{face[0], face[1], face[2]};
    std::ranges::rotate(corners, std::ranges::min_element(corners));
    all.insert(corners);
  }
  return all;
}

TEST(Ply, StripsAreTrianglesOfOneSide) {
  std::vector<int> each_side, in_one;
  for (const auto& [a, b, c, d] : kCubeQuads) {
    each_side.insert(each_side.end(), {a, b, d, c, -1});
    // A strip goes on to the next side by two corners that come twice.
    if (!in_one.empty()) in_one.insert(in_one.end(), {in_one.back(), a});
    in_one.insert(in_one.end(), {a, b, d, c});
  }
  for (const bool is_text : {true, false}) {
    const TriMesh apart = read_file(strips_ply(each_side, is_text)).surfaces()[0].mesh;
    EXPECT_EQ(apart.faces.size(), 12U);
    EXPECT_DOUBLE_EQ(volume(apart), 6);
    const TriMesh joined = read_file(strips_ply(in_one, is_text)).surfaces()[0].mesh;
    EXPECT_EQ(turned_triangles(joined), turned_triangles(apart));
  }
}

TEST(Ply, NormalsAreKept) {
  const Asset asset = read_file(cube_text_ply());
  const std::vector<ReadPrimitive> answer =
      read_naively(write(asset, split_everywhere(asset), Format::glb));
  for (const Face& face : answer[0].faces)
    EXPECT_EQ(face.at("NORMAL")[0], (std::vector<double>{0, 0, 1}));
  EXPECT_THAT(write(asset, split_everywhere(asset), Format::obj), HasSubstr("vn 0 0 1\n"));
}

TEST(Ply, LineEndsOfEverySystemAreRead) {
  for (const std::string end : {"\r\n", "\r"}) {
    std::string head = ply_head("binary_little_endian");
    const std::string values = cube_binary_ply(false).substr(head.size());
    for (std::size_t at = head.find('\n'); at != std::string::npos;
         at = head.find('\n', at + end.size()))
      head.replace(at, 1, end);
    EXPECT_DOUBLE_EQ(volume(read_file(head + values).surfaces()[0].mesh), 6);
  }
}

TEST(Off, VariantsAreRead) {
  const std::string cube = cube_off();
  for (const std::string& file :
       {replaced(cube, "OFF # a cube\n", "OFF"), replaced(cube, "8 6 12", "8 6"),
        replaced(cube, "OFF", "\xef\xbb\xbfOFF"), replaced(cube, "OFF", "\xef\xbb\xbf\t \n OFF"),
        replaced(cube, "OFF", "# of a library\r\n\n  # 8 corners\n OFF"),
        replaced(cube, "OFF", "COFF"), replaced(cube, "OFF", "STOFF"),
        replaced(cube, "\n0 0 0\n", "\n# x\n0 0 0 255 0 0 # y\n")})
    EXPECT_DOUBLE_EQ(volume(read_file(file).surfaces()[0].mesh), 6) << file.substr(0, 40);
  const Asset asset = read_file("NOFF\n3 1 0\n0 0 0 0 0 2\n1 0 0 0 0 2\n0 1 0 0 0 2\n3 0 1 2\n");
  const std::string answer = write(asset, split_everywhere(asset), Format::glb);
  EXPECT_EQ(read_naively(answer)[0].faces[0].at("NORMAL")[2], (std::vector<double>{0, 0, 1}));
}

TEST(Off, WhatFollowsOnALineIsToldAsLeftOut) {
  const auto dropped = [](const std::string& file) {
    std::string text;
    const Asset asset = read_file(file);
    for (const Note& note : side_effects(asset, split_everywhere(asset), Format::glb))
      if (note.code == NoteCode::data_dropped) text += note.text;
    return text;
  };
  const std::string vertices = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0", face = "\n3 0 1 2";
  EXPECT_THAT(dropped(vertices + face + " 255 0 0\n"), HasSubstr(": face colours."));
  EXPECT_THAT(dropped(vertices + face + " 7"), HasSubstr(": face colours."));
  EXPECT_THAT(dropped(vertices + " 7" + face), HasSubstr(": vertex colours."));  // of a list
  EXPECT_THAT(dropped("STC" + vertices + " 1 0 0 1 0 0" + face + " 3"),
              HasSubstr(": texture coordinates, vertex colours, face colours."));
  EXPECT_EQ(dropped("C" + vertices + " 1 0 0 1" + face), "");
  for (const char* end : {"", "\n", "\r\n", " \t \n", "  # red\n", " \r# red\n"})
    EXPECT_EQ(dropped(vertices + face + end), "") << end;
  EXPECT_EQ(dropped(vertices + " # red" + face), "");
}

}  // namespace
}  // namespace unwrapd::asset::test
