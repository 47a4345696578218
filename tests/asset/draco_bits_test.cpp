// compression=draco with draco_bits: what is rounded, by how much, and what stays exact.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "core/asset/codec/compress.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

/// Every file here is decoded by Draco's own decoder, on its way through another unwrapping.
std::vector<ReadPrimitive> decoded(const std::string& file) {
  const Asset asset = read_file(file, {.texcoord = 7, .compression = Compression::none});
  return read_naively(write(asset, split_nowhere(asset), Format::glb));
}

std::string packed(const std::string& file, std::optional<int> bits) {
  const Asset asset = read_file(file, {.compression = Compression::draco, .draco_bits = bits});
  return write(asset, split_nowhere(asset), Format::glb);
}

/// UVs on the lattice of results, 2^-24, over the whole page.
std::vector<UnwrappedSurface> on_lattice(const Asset& asset) {
  std::mt19937 random(5);
  std::vector<UnwrappedSurface> unwrapped = split_nowhere(asset);
  for (UnwrappedSurface& surface : unwrapped)
    for (Vec2& uv : surface.uv)
      uv = Vec2(random() % (1U << 24), random() % (1U << 24)) / (1U << 24);
  return unwrapped;
}

/// A grid with normals of length 1, large and far from the origin.
Builder far_grid(int n) {
  std::vector<double> points, normals, corners;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k) {
      for (const double x : {1000.0 + i * 0.37, -50.0 + k * 0.11, std::sin(0.02 * i * k)})
        points.push_back(static_cast<float>(x));
      const Vec3 normal = Vec3(std::sin(0.1 * i), std::cos(0.1 * k), 0.3).normalized();
      normals.insert(normals.end(), {normal.x(), normal.y(), normal.z()});
      if (i == n || k == n) continue;
      const int at = i * (n + 1) + k;
      for (const int v : {at, at + n + 1, at + 1, at + 1, at + n + 1, at + n + 2})
        corners.push_back(v);
    }
  Builder b;
  const std::size_t position = b.add("VEC3", 5126, points), normal = b.add("VEC3", 5126, normals);
  for (std::size_t k = 0; k < 3; ++k) {
    double low = points[k], high = points[k];
    for (std::size_t i = k; i < points.size(); i += 3) {
      low = std::min(low, points[i]);
      high = std::max(high, points[i]);
    }
    b.json["accessors"][position]["min"].push_back(low);
    b.json["accessors"][position]["max"].push_back(high);
  }
  b.add_primitive({{"POSITION", position}, {"NORMAL", normal}}, b.add("SCALAR", 5125, corners));
  return b;
}

/// The most that positions of these primitives may move.
double bound_of(const std::vector<ReadPrimitive>& primitives, int bits) {
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const ReadPrimitive& primitive : primitives)
    for (const Face& face : primitive.faces)
      for (const Vec3& point : points_of(face)) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
      }
  return codec::draco_position_error(low, high, bits);
}

TEST(DracoBits, PositionsMoveByTheSaidBoundAndNormalsByAQuarterOfADegree) {
  const std::string file = far_grid(30).glb();
  const std::vector<ReadPrimitive> before = read_naively(file);
  for (const int bits : {8, 11, 14, 18}) {
    const std::vector<ReadPrimitive> after = decoded(packed(file, bits));
    const double bound = bound_of(before, bits);
    double moved = 0, turned = 0;
    ASSERT_EQ(after[0].faces.size(), before[0].faces.size());
    for (std::size_t t = 0; t < before[0].faces.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 shift = points_of(after[0].faces[t])[k] - points_of(before[0].faces[t])[k];
        moved = std::max(moved, shift.cwiseAbs().maxCoeff());
        const auto normal = [&](const std::vector<ReadPrimitive>& read) {
          const std::vector<double>& x = read[0].faces[t].at("NORMAL")[k];
          return Vec3(x[0], x[1], x[2]).normalized();
        };
        turned = std::max(turned, normal(before).cross(normal(after)).norm());
      }
    EXPECT_LE(moved, bound) << bits;
    EXPECT_GT(moved, bound / 4) << bits;  // it is rounded indeed
    EXPECT_LE(turned, 0.25 * std::acos(-1) / 180) << bits;
  }
}

TEST(DracoBits, TextureCoordinatesStayExactOnTheirLattice) {
  const Asset asset =
      read_file(grid(40).glb(), {.compression = Compression::draco, .draco_bits = 10});
  const std::vector<UnwrappedSurface> unwrapped = on_lattice(asset);
  const std::string small = write(asset, unwrapped, Format::glb);
  const Asset plain = read_file(grid(40).glb());
  const std::vector<ReadPrimitive> expected = read_naively(write(plain, unwrapped, Format::glb));
  const std::vector<ReadPrimitive> after = decoded(small);
  for (std::size_t t = 0; t < expected[0].faces.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(after[0].faces[t].at("TEXCOORD_0")[k], expected[0].faces[t].at("TEXCOORD_0")[k]);
}

TEST(DracoBits, SetsThatLieOnNoLatticeStayExactToo) {
  Builder b = grid(10);
  std::mt19937 random(2);
  std::vector<double> uv;
  for (int i = 0; i < 2 * 11 * 11; ++i)
    uv.push_back(static_cast<float>(
        std::ldexp(static_cast<double>(random() % 100'003) / 7, -static_cast<int>(random() % 40))));
  const std::size_t other = b.add("VEC2", 5126, uv);
  Json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = attributes["TEXCOORD_1"] = other;
  const std::vector<ReadPrimitive> before = read_naively(b.glb());
  const std::vector<ReadPrimitive> after = decoded(packed(b.glb(), 8));
  for (std::size_t t = 0; t < before[0].faces.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(after[0].faces[t].at("TEXCOORD_1")[k], before[0].faces[t].at("TEXCOORD_1")[k]);
}

/// Two halves of a plane that share an edge, each a primitive of its own box.
TEST(DracoBits, PrimitivesOfAMeshDoNotComeApart) {
  Builder b;
  std::vector<std::size_t> corners;
  for (const double side : {-1.0, 7.3}) {
    std::vector<double> points;
    for (int k = 0; k < 50; ++k) {
      const double y = std::sqrt(k) / 3;
      points.insert(points.end(), {0, y, std::sin(y), side, y, 0.1});
    }
    const std::size_t position = b.add("VEC3", 5126, points);
    std::vector<double> faces;
    for (int k = 0; k + 1 < 50; ++k)
      for (const int v : {2 * k, 2 * k + 1, 2 * k + 2}) faces.push_back(v);
    b.add_primitive({{"POSITION", position}}, b.add("SCALAR", 5125, faces));
  }
  const std::vector<ReadPrimitive> after = decoded(packed(b.glb(), 8));
  ASSERT_EQ(after.size(), 2U);
  for (std::size_t t = 0; t < 49; ++t)
    EXPECT_EQ(points_of(after[0].faces[t])[0], points_of(after[1].faces[t])[0]);
}

/// The file with UVs that run over the page as those of a map do, on the lattice of results.
std::string mapped(const std::string& file, std::optional<int> bits) {
  const Asset asset = read_file(file, {.compression = Compression::draco, .draco_bits = bits});
  std::vector<UnwrappedSurface> unwrapped = split_nowhere(asset);
  for (UnwrappedSurface& surface : unwrapped)
    for (std::size_t v = 0; v < surface.uv.size(); ++v) {
      const Vec3& point = asset.surfaces()[0].mesh.positions[v];
      const Vec2 place((point.x() - 1000) / 30, (point.y() + 50) / 30);
      surface.uv[v] = (place * (1 << 24)).array().floor() / (1 << 24);
    }
  return write(asset, unwrapped, Format::glb);
}

TEST(DracoBits, SaveBytesAndBoundsHold) {
  const std::string file = far_grid(60).glb();
  const std::string exact = mapped(file, std::nullopt), small = mapped(file, 14);
  EXPECT_LT(small.size(), exact.size() / 2);
  EXPECT_LT(mapped(file, 8).size(), small.size());
  const Json document = json_of(small);
  const Json& accessor =
      document["accessors"]
              [document["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()];
  for (const ReadPrimitive& primitive : decoded(small))
    for (const Face& face : primitive.faces)
      for (const std::vector<double>& point : face.at("POSITION"))
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_GE(point[k], accessor["min"][k].get<double>());
          EXPECT_LE(point[k], accessor["max"][k].get<double>());
        }
}

/// Draco that came in and shall be kept is not rounded a second time.
TEST(DracoBits, KeepKeepsAllValues) {
  const std::string came = packed(far_grid(12).glb(), std::nullopt);
  const Asset asset =
      read_file(came, {.texcoord = 7, .compression = Compression::keep, .draco_bits = 8});
  const std::string kept = write(asset, split_nowhere(asset), Format::glb);
  ASSERT_NE(kept.find("KHR_draco_mesh_compression"), std::string::npos);
  const std::vector<ReadPrimitive> before = decoded(came), after = decoded(kept);
  ASSERT_EQ(after[0].faces.size(), before[0].faces.size());
  for (std::size_t t = 0; t < before[0].faces.size(); ++t)
    for (const char* semantic : {"POSITION", "NORMAL"})
      EXPECT_EQ(after[0].faces[t].at(semantic), before[0].faces[t].at(semantic));
}

/// The length that the note tells.
double told_bound(const std::vector<Note>& notes) {
  for (const Note& note : notes)
    if (note.code == NoteCode::positions_rounded)
      return std::stod(note.text.substr(note.text.find("at most ") + 8));
  return 0;
}

/// A cloud of triangles in a cube of side 3, far from the origin: in floats for a glTF, in doubles
/// for an OBJ.
TEST(DracoBits, TheNoteHoldsForFloatsFarFromTheOrigin) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> any(0, 3);
  for (const double offset : {0.0, 0.7, 100.0, 1e3, 1e6})
    for (const int bits : {8, 14, 18, 22}) {
      std::string obj;
      std::vector<Vec3> points;
      for (int i = 0; i < 3000; ++i) {
        points.emplace_back(offset + any(random), any(random), any(random));
        std::array<char, 128> line{};
        std::snprintf(line.data(), line.size(), "v %.17g %.17g %.17g\n", points[i].x(),
                      points[i].y(), points[i].z());
        obj += line.data();
        if (i % 3 == 2) obj += "f -3 -2 -1\n";
      }
      const Asset asset = read_file(obj, {.compression = Compression::draco, .draco_bits = bits});
      const double told = told_bound(side_effects(asset, split_nowhere(asset), Format::glb));
      const std::string file = write(asset, split_nowhere(asset), Format::glb);
      const Json node = json_of(file)["nodes"][0];
      const auto origin = node.value("translation", std::vector<double>{0, 0, 0});
      const std::vector<ReadPrimitive> after = decoded(file);
      double moved = 0;
      for (std::size_t i = 0; i < points.size(); ++i)
        moved = std::max(moved, (points_of(after[0].faces[i / 3])[i % 3] - points[i] +
                                 Vec3(origin[0], origin[1], origin[2]))
                                    .cwiseAbs()
                                    .maxCoeff());
      EXPECT_LE(moved, told) << offset << ", " << bits << " bits";
      EXPECT_GT(moved, told / 6) << offset << ", " << bits << " bits";
    }
}

TEST(DracoBits, ANoteSaysTheError) {
  const auto notes_with = [](const AssetOptions& options, Format output) {
    const Asset asset = read_file(grid(4).glb(), options);
    std::vector<Note> notes = side_effects(asset, split_nowhere(asset), output);
    std::erase_if(notes, [](const Note& n) { return n.code != NoteCode::positions_rounded; });
    return notes;
  };
  const AssetOptions draco = {.compression = Compression::draco, .draco_bits = 14};
  ASSERT_EQ(notes_with(draco, Format::glb).size(), 1U);
  EXPECT_NE(notes_with(draco, Format::glb)[0].text.find("14 bits"), std::string::npos);
  EXPECT_TRUE(notes_with(draco, Format::obj).empty());
  EXPECT_TRUE(notes_with({.compression = Compression::draco}, Format::glb).empty());
  EXPECT_TRUE(
      notes_with({.compression = Compression::keep, .draco_bits = 14}, Format::glb).empty());
}

}  // namespace
}  // namespace unwrapd::asset::test
