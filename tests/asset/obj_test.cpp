#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <sstream>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

const std::string kCube = R"(# a comment
mtllib cube.mtl
o Cube
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
vt 0.5 0.5
vn 0 0 -1
vn 0 0 1
g bottom
usemtl Red
f 4/1/1 3/1/1 2/1/1 1/1/1   # turned
usemtl Blue
s off
f 5//2 6//2 7//2 8//2
f 1 2 6 5
usemtl Red
f -6 -5 -1 -2
foo bar
l 1/1 2/1
)";

/// Everything of an OBJ but its v, vt and f statements.
std::vector<std::string> other_lines(const std::string& obj) {
  std::vector<std::string> lines;
  std::istringstream stream(obj);
  for (std::string line; std::getline(stream, line);)
    if (!line.starts_with("vt ") && !line.starts_with("f ")) lines.push_back(line);
  return lines;
}

/// The cube laid out as a frame: every quad is convex, as on a page.
std::vector<UnwrappedSurface> as_frame(const Asset& cube) {
  std::vector<UnwrappedSurface> unwrapped = split_nowhere(cube);
  unwrapped[0].uv = {{.375, .375}, {.625, .375}, {.625, .625}, {.375, .625},
                     {.125, .125}, {.875, .125}, {.875, .875}, {.125, .875}};
  return unwrapped;
}

std::string line_with(const std::string& text, const std::string& start) {
  const std::size_t at = text.find("\n" + start);
  return at == std::string::npos ? "" : text.substr(at + 1, text.find('\n', at + 1) - at - 1);
}

TEST(Obj, PolygonsNegativeIndicesAndPartsAreRead) {
  const Asset asset = read_file(kCube);
  const Surface& surface = asset.surfaces()[0];
  EXPECT_EQ(surface.mesh.vertex_count(), 8);
  ASSERT_EQ(surface.mesh.face_count(), 8);
  EXPECT_EQ(surface.part, (std::vector<Index>{1, 1, 2, 2, 2, 2, 1, 1}));
  EXPECT_EQ(surface.mesh.faces[0], (Triangle{3, 2, 1}));
  EXPECT_EQ(surface.mesh.faces[7][0], 2);
  EXPECT_EQ(surface.name, "obj");
}

TEST(Obj, MaterialsKeepTheirNamesInAGltf) {
  std::string latin = kCube;
  latin.replace(latin.find("usemtl Blue"), 11,
                "usemtl dark gr\xfcn  # one\nusemtl Red\nusemtl Blue");
  const Asset asset = read_file(latin + "usemtl L\xe4rche\nf 1 2 3\n");
  const Json json = json_of(write(asset, split_everywhere(asset), Format::glb));
  ASSERT_EQ(json["materials"].size(), 3);  // "dark gr\xfcn" has no faces
  EXPECT_EQ(json["materials"][0]["name"], "Red");
  EXPECT_EQ(json["materials"][1]["name"], "Blue");
  EXPECT_EQ(json["materials"][2]["name"], "L\xef\xbf\xbdrche");  // not UTF-8
  for (std::size_t p = 0; p < 3; ++p) EXPECT_EQ(json["meshes"][0]["primitives"][p]["material"], p);
  const std::vector<Note> notes = side_effects(asset, split_everywhere(asset), Format::glb);
  const auto dropped = std::ranges::find(notes, NoteCode::data_dropped, &Note::code);
  ASSERT_NE(dropped, notes.end());
  EXPECT_NE(dropped->text.find("(4)"), std::string::npos) << dropped->text;
  for (const Note& note : side_effects(asset, split_everywhere(asset), Format::obj))
    EXPECT_NE(note.code, NoteCode::data_dropped);
}

TEST(Obj, OnlyTexcoordsAndFacesChange) {
  const Asset asset = read_file(kCube);
  const std::string answer = write(asset, as_frame(asset), Format::obj);
  std::vector<std::string> expected = other_lines(kCube);
  expected.back() = "l 1 2";
  EXPECT_EQ(other_lines(answer), expected);
  EXPECT_EQ(line_with(answer, "f 4"), "f 4/4/1 3/3/1 2/2/1 1/1/1   # turned");
  EXPECT_EQ(line_with(answer, "f 1"), "f 1/1 2/2 6/6 5/5");
  EXPECT_EQ(line_with(answer, "f 3"), "f 3/3 4/4 8/8 7/7");
  EXPECT_LT(answer.find("\nvt "), answer.find("\nf "));
  EXPECT_EQ(answer.find("vt 0.5 0.5"), std::string::npos);
}

std::vector<Note> polygon_notes(const Asset& asset,
                                const std::vector<UnwrappedSurface>& unwrapped) {
  std::vector<Note> notes = side_effects(asset, unwrapped, Format::obj);
  std::erase_if(notes, [](const Note& note) { return note.code != NoteCode::polygons_split; });
  return notes;
}

TEST(Obj, APolygonIsCutOnlyWhereASeamRunsThroughIt) {
  const Asset asset = read_file(kCube);
  std::vector<UnwrappedSurface> unwrapped = as_frame(asset);
  UnwrappedSurface& surface = unwrapped[0];
  surface.faces[1][0] = 8;  // the second triangle of the first polygon has a corner of its own
  surface.source.push_back(asset.surfaces()[0].mesh.faces[1][0]);
  surface.uv.emplace_back(0.125, 0.25);
  const std::string answer = write(asset, unwrapped, Format::obj);
  EXPECT_NE(answer.find("f 4/4/1 3/3/1 2/2/1\nf 4/9/1 2/2/1 1/1/1   # turned\n"),
            std::string::npos);
  EXPECT_NE(answer.find("\nvt 0.125 0.25\n"), std::string::npos);
  EXPECT_NE(answer.find("f 1/1 2/2 6/6 5/5"), std::string::npos);
  const std::vector<Note> notes = polygon_notes(asset, unwrapped);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].text,
            "1 of 4 polygons are written as triangles: 1 because a seam runs through them, 0 "
            "because they are not convex on the page, where other diagonals would flip.");
}

TEST(Obj, APolygonThatIsNotConvexOnThePageIsWrittenAsTriangles) {
  const Asset asset = read_file(kCube);
  std::vector<UnwrappedSurface> unwrapped = as_frame(asset);
  EXPECT_TRUE(polygon_notes(asset, unwrapped).empty());
  unwrapped[0].uv[1] = {.4375, .5};  // 2, beyond the diagonal from 1 to 3
  const std::string answer = write(asset, unwrapped, Format::obj);
  EXPECT_EQ(answer.find("f 4/4/1 3/3/1 2/2/1 1/1/1"), std::string::npos);
  EXPECT_NE(answer.find("f 5/5/2 6/6/2 7/7/2 8/8/2"), std::string::npos);
  EXPECT_EQ(polygon_notes(asset, unwrapped).size(), 1U);
  unwrapped[0].uv[1] = unwrapped[0].uv[0];  // a triangle without area folds nothing
  EXPECT_TRUE(polygon_notes(asset, unwrapped).empty());
}

TEST(Obj, APolygonThatWindsTwiceAroundIsWrittenAsTriangles) {
  std::string text;
  std::string face = "f";
  UvMap star;
  for (int i = 0; i < 5; ++i) {
    const double angle = 0.8 * 3.14159265358979 * i;  // every corner turns left
    text += "v " + std::to_string(i) + " " + std::to_string(i * i) + " 0\n";
    star.emplace_back(std::round(400 + 300 * std::cos(angle)) / 1024,
                      std::round(400 + 300 * std::sin(angle)) / 1024);
    face += " " + std::to_string(i + 1);
  }
  const Asset asset = read_file(text + face);
  std::vector<UnwrappedSurface> unwrapped = split_nowhere(asset);
  unwrapped[0].uv = star;
  EXPECT_EQ(polygon_notes(asset, unwrapped).size(), 1U);
}

TEST(Obj, TexcoordsAreTheSameNumbersAsFloatsAndAsDoubles) {
  const Asset asset = read_file("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  std::mt19937 rng(1);
  for (int round = 0; round < 1000; ++round) {
    std::vector<UnwrappedSurface> unwrapped = split_nowhere(asset);
    for (Vec2& uv : unwrapped[0].uv)
      for (double& x : uv) x = std::ldexp(double(rng() >> (rng() % 24)) / 256, -24);
    std::istringstream answer(write(asset, unwrapped, Format::obj));
    std::size_t vertex = 0;
    for (std::string line; std::getline(answer, line);) {
      if (!line.starts_with("vt ")) continue;
      const std::size_t second = line.find(' ', 3) + 1;
      for (const auto& [at, k] : {std::pair(std::size_t{3}, 0), std::pair(second, 1)}) {
        const double expected = static_cast<float>(unwrapped[0].uv.at(vertex)[k]);
        EXPECT_EQ(std::strtod(line.c_str() + at, nullptr), expected) << line;
        EXPECT_EQ(std::strtof(line.c_str() + at, nullptr), static_cast<float>(expected)) << line;
      }
      ++vertex;
    }
    EXPECT_EQ(vertex, 3U);
  }
}

TEST(Obj, WhatIsWrittenReadsBackWithTheSameFaces) {
  for (const std::string& text : {kCube, std::string("v 0 0 0\r\nv 1 0 0\r\nv 0 1 \\\r\n 0\r\n"
                                                     "f 1 2 \\\r\n3\r\n")}) {
    const Asset asset = read_file(text);
    const std::string answer = write(asset, split_everywhere(asset), Format::obj);
    const Asset again = read_file(answer);
    EXPECT_EQ(again.surfaces()[0].mesh.faces, asset.surfaces()[0].mesh.faces);
    EXPECT_EQ(again.surfaces()[0].mesh.positions, asset.surfaces()[0].mesh.positions);
    EXPECT_EQ(again.surfaces()[0].part, asset.surfaces()[0].part);
    const std::string twice = write(again, split_everywhere(again), Format::obj);
    EXPECT_EQ(twice, answer);
  }
}

TEST(Obj, FaultsAreNamedWithTheirLine) {
  const std::vector<std::pair<std::string, ErrorCode>> faults = {
      {"f 1 2 x", ErrorCode::malformed_obj},
      {"f 1 2 4", ErrorCode::malformed_obj},
      {"f 0 1 2", ErrorCode::malformed_obj},
      {"f -4 1 2", ErrorCode::malformed_obj},
      {"f 1 2 3/1/1", ErrorCode::malformed_obj},
      {"f 1 2 3/1/1/1", ErrorCode::malformed_obj},
      {"f 1 2 99999999999", ErrorCode::malformed_obj},
      {"v 1 2", ErrorCode::malformed_obj},
      {"v 1 2 zwei", ErrorCode::malformed_obj},
      {"v 1 2 nan", ErrorCode::non_finite_position},
      {"v 1 -inf 2", ErrorCode::non_finite_position},
      {"v 1e400 0 0", ErrorCode::non_finite_position},
      {"v 1e39 0 0", ErrorCode::non_finite_position}};
  for (const auto& [line, code] : faults) {
    const Error error = error_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" + line + "\nf 1 2 3\n");
    EXPECT_EQ(error.code(), code) << line;
    EXPECT_EQ(error.where(), "line 5") << line;
  }
  EXPECT_EQ(error_of("v 0 0 0\nv 1 0 0\n").code(), ErrorCode::no_triangles);
}

TEST(Obj, SmallOddNumbersAreNumbers) {
  const Asset asset = read_file("v +1 -.5 1e-400\nv 1. 0 0 1 0.5 0.5 0.5\nv\t0 1 0\nf 1 2 3");
  EXPECT_EQ(asset.surfaces()[0].mesh.positions[0], Vec3(1, -0.5, 0));
}

TEST(Obj, LimitsHold) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n";
  EXPECT_EQ(error_of(text, {.max_vertices = 3}).where(), "line 4");
  EXPECT_EQ(error_of(text, {.max_faces = 1}).code(), ErrorCode::too_many_faces);
  EXPECT_EQ(read({text, {}}, {.max_vertices = 4, .max_faces = 2}).surfaces().size(), 1U);
}

TEST(Obj, EveryPrefixIsReadOrRefused) {
  for (std::size_t length = 0; length < kCube.size(); ++length) {
    try {
      const Asset asset = read_file(kCube.substr(0, length));
      EXPECT_FALSE(write(asset, split_everywhere(asset), Format::obj).empty());
    } catch (const Error& error) {
      EXPECT_FALSE(std::string(error.what()).empty());
    }
  }
}

double area_of(const TriMesh& mesh) {
  double area = 0;
  for (const Triangle& face : mesh.faces) {
    const auto at = [&](std::size_t k) {
      return mesh.positions[static_cast<std::size_t>(face[k])];
    };
    area += (at(1) - at(0)).cross(at(2) - at(0)).z() / 2;
  }
  return area;
}

TEST(Obj, ConcavePolygonsAreCutIntoTrianglesThatDoNotOverlap) {
  // An arrow and a comb: a fan would leave triangles of the wrong sign, and their areas differ.
  const Asset arrow = read_file("v 0 0 0\nv 2 -1 0\nv 1 0 0\nv 2 1 0\nf 3 4 1 2\n");
  const Asset comb = read_file(
      "v 0 0 0\nv 5 0 0\nv 5 3 0\nv 4 1 0\nv 3 3 0\nv 2 1 0\nv 1 3 0\nv 0 1 0\n"
      "f 1 2 3 4 5 6 7 8\n");
  for (const auto& [asset, area] : {std::pair(&arrow, 1.0), std::pair(&comb, 10.0)}) {
    const TriMesh& mesh = asset->surfaces()[0].mesh;
    EXPECT_NEAR(area_of(mesh), area, 1e-12);
    for (std::size_t t = 0; t < mesh.faces.size(); ++t)
      EXPECT_GT(area_of({mesh.positions, {mesh.faces[t]}}), 0) << t;
  }
}

TEST(Obj, AsGltfItHasTheSameFacesNormalsAndUvs) {
  const Asset asset = read_file(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nvn 0 0 2\nvn 0 1 0\nusemtl a\nf 1//1 2//1 3//2\n"
      "usemtl b\nf 1//1 3//1 4//2\n");
  for (const Format format : {Format::glb, Format::gltf}) {
    const std::string answer = write(asset, split_everywhere(asset), format);
    const std::vector<ReadPrimitive> primitives = read_naively(answer);
    ASSERT_EQ(primitives.size(), 2U);
    EXPECT_EQ(primitives[0].faces[0].at("NORMAL")[0], (std::vector<double>{0, 0, 1}));
    EXPECT_EQ(primitives[0].faces[0].at("NORMAL")[2], (std::vector<double>{0, 1, 0}));
    std::vector<ReadPrimitive> expected = primitives;
    expect_same_but_uv(expected, primitives);
    EXPECT_EQ(points_of(primitives[1].faces[0])[2], Vec3(0, 1, 1));
    EXPECT_EQ(read_file(answer).surfaces()[0].mesh.face_count(), 2);
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
