// Positions in doubles that floats, which glTF has, cannot hold where they are.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <sstream>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

struct Far {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
};

/// A bent grid, 20 by 20 quads over 2 by 2 units, moved and scaled.
Far far_grid(const Vec3& offset, double scale = 1) {
  constexpr int kSide = 20;
  Far grid;
  for (int i = 0; i <= kSide; ++i)
    for (int k = 0; k <= kSide; ++k) {
      grid.points.emplace_back(offset + scale * Vec3(0.1 * i, 0.1 * k, 0.2 * std::sin(0.3 * i)));
      if (i == kSide || k == kSide) continue;
      const int at = i * (kSide + 1) + k;
      grid.faces.push_back({at, at + kSide + 1, at + 1});
      grid.faces.push_back({at + 1, at + kSide + 1, at + kSide + 2});
    }
  return grid;
}

void put(std::ostream& out, const Vec3& point) {
  out.precision(17);
  out << point.x() << ' ' << point.y() << ' ' << point.z() << '\n';
}

std::string ply_of(const Far& mesh) {
  std::ostringstream out;
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.points.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
      << mesh.faces.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& point : mesh.points) put(out, point);
  for (const auto& [a, b, c] : mesh.faces) out << "3 " << a << ' ' << b << ' ' << c << '\n';
  return out.str();
}

std::string obj_of(const Far& mesh) {
  std::ostringstream out;
  for (const Vec3& point : mesh.points) put(out << "v ", point);
  for (const auto& [a, b, c] : mesh.faces)
    out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return out.str();
}

Vec3 translation_of(const std::string& file) {
  const Json node = json_of(file).at("nodes").at(0);
  if (!node.contains("translation")) return Vec3::Zero();
  const auto move = node.at("translation").get<std::array<double, 3>>();
  return {move[0], move[1], move[2]};
}

std::vector<NoteCode> codes(const Asset& asset, Format output) {
  std::vector<NoteCode> found;
  for (const Note& note : side_effects(asset, split_everywhere(asset), output))
    if (note.code == NoteCode::origin_moved || note.code == NoteCode::positions_rounded)
      found.push_back(note.code);
  return found;
}

/// The triangles have the file's shape to a ten-millionth of its size, and its place exactly.
void expect_kept(const Far& mesh, const std::string& written, double tolerance) {
  const Vec3 origin = translation_of(written);
  const std::vector<ReadPrimitive> answer = read_naively(written);
  ASSERT_EQ(answer.at(0).faces.size(), mesh.faces.size());
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    const std::array<Vec3, 3> got = points_of(answer[0].faces[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& want = mesh.points[static_cast<std::size_t>(mesh.faces[t][k])];
      ASSERT_LE((got[k] + origin - want).cwiseAbs().maxCoeff(), tolerance) << t;
    }
    ASSERT_GT((got[1] - got[0]).cross(got[2] - got[0]).norm(), 1e-3) << t;
  }
}

const std::vector<Vec3> kFarPlaces = {{5e5, 5.4e6, 0}, {1e7, -1e7, 3}, {1e8, 1e8, 1e8}};

TEST(FarOffset, KeepsTheShapeOfEveryFormat) {
  for (const Vec3& place : kFarPlaces) {
    const Far mesh = far_grid(place);
    for (const std::string& file : {ply_of(mesh), obj_of(mesh)}) {
      const Asset asset = read_file(file);
      for (const Format output : {Format::glb, Format::gltf})
        expect_kept(mesh, write(asset, split_everywhere(asset), output), 2e-7);
      EXPECT_EQ(codes(asset, Format::glb), std::vector{NoteCode::origin_moved});
      EXPECT_TRUE(codes(asset, Format::obj).empty());
    }
  }
}

TEST(FarOffset, TheNodeMovesByNumbersThatFloatsHold) {
  const Asset asset = read_file(ply_of(far_grid({5e5, 5.4e6, 0})));
  const Vec3 origin = translation_of(write(asset, split_everywhere(asset), Format::glb));
  EXPECT_EQ(origin, origin.cast<float>().cast<double>());
  EXPECT_LE((origin - Vec3(5e5 + 1, 5.4e6 + 1, 0)).cwiseAbs().maxCoeff(), 1);
}

/// GCC 12 takes a rounding to float for none where it works on two numbers at once.
TEST(FarOffset, TellsHowFarFloatsInPlaceWouldMoveAPoint) {
  const Far mesh = far_grid({5e5, 5.4e6, 0});
  double most = 0;
  for (const Vec3& point : mesh.points)
    for (const double x : point) {
      const volatile float rounded = static_cast<float>(x);
      most = std::max(most, std::abs(static_cast<double>(rounded) - x));
    }
  std::array<char, 32> told{};
  std::snprintf(told.data(), told.size(), "by up to %.3g so far", most);
  const Asset asset = read_file(ply_of(mesh));
  const std::vector<Note> notes = side_effects(asset, split_everywhere(asset), Format::glb);
  EXPECT_TRUE(std::ranges::any_of(notes, [&told](const Note& note) {
    return note.text.find(told.data()) != std::string::npos;
  })) << told.data();
}

TEST(FarOffset, StaysWithCompression) {
  const Far mesh = far_grid({5e5, 5.4e6, 0});
  for (const Compression compression : {Compression::meshopt, Compression::draco}) {
    const Asset asset = read_file(ply_of(mesh), {.compression = compression});
    const std::string packed = write(asset, split_everywhere(asset), Format::glb);
    EXPECT_EQ(translation_of(packed),
              translation_of(write(read_file(ply_of(mesh)), split_everywhere(asset), Format::glb)));
    const Asset again = read_file(packed);
    expect_kept(mesh, write(again, split_everywhere(again), Format::glb), 2e-7);
  }
}

/// What floats hold well enough, or came in floats, stays where it is.
TEST(FarOffset, NearMeshesStay) {
  for (const Vec3& place : {Vec3(0, 0, 0), Vec3(10, -20, 30)}) {
    const Asset asset = read_file(ply_of(far_grid(place)));
    const std::string written = write(asset, split_everywhere(asset), Format::glb);
    EXPECT_FALSE(json_of(written).at("nodes").at(0).contains("translation"));
    EXPECT_TRUE(codes(asset, Format::glb).empty());
  }
}

/// Rounding moves no point by much of a large mesh, but makes one point of a small face.
TEST(FarOffset, MovesWhereSmallEdgesWouldCollapse) {
  Far mesh = far_grid({500, 500, 0}, 10);
  for (const double x : {0.0, 1e-5})
    for (const double y : {0.0, 1e-5}) mesh.points.emplace_back(510 + x, 510 + y, 0);
  mesh.faces.push_back({441, 443, 442});
  const Asset asset = read_file(ply_of(mesh));
  const std::array<Vec3, 3> face = points_of(
      read_naively(write(asset, split_everywhere(asset), Format::glb)).at(0).faces.back());
  EXPECT_GT((face[1] - face[0]).norm(), 0);
  EXPECT_GT((face[2] - face[0]).norm(), 0);
  EXPECT_EQ(codes(asset, Format::glb), std::vector{NoteCode::origin_moved});
}

TEST(FarOffset, TellsOfFacesThatNoFloatsHold) {
  Far mesh = far_grid({0, 0, 0});
  for (const double x : {0.0, 1e-9})
    for (const double y : {0.0, 1e-9}) mesh.points.emplace_back(1 + x, 1 + y, 0);
  mesh.faces.push_back({441, 443, 442});
  const Asset asset = read_file(ply_of(mesh));
  EXPECT_EQ(codes(asset, Format::glb), std::vector{NoteCode::positions_rounded});
  EXPECT_TRUE(codes(asset, Format::obj).empty());
}

TEST(FarOffset, RefusesMeshesThatAreTooSmallForFloats) {
  for (const double scale : {1e-44, 1e-50, 1e-300}) {
    const Asset asset = read_file(ply_of(far_grid({0, 0, 0}, scale)));
    try {
      write(asset, split_everywhere(asset), Format::glb);
      ADD_FAILURE() << "it was written at " << scale;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::zero_area);
      EXPECT_NE(std::string(error.what()).find("output=obj"), std::string::npos);
    }
    EXPECT_NO_THROW(write(asset, split_everywhere(asset), Format::obj));
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
