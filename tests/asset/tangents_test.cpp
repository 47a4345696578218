// Tangents for new texture coordinates, held to formulas that know nothing of how they are made.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "core/asset/writer/tangent_space.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

Vec3 vec3(const std::vector<double>& values) { return {values[0], values[1], values[2]}; }

std::vector<double> repeated(std::vector<double> values, std::size_t times) {
  std::vector<double> all;
  for (std::size_t i = 0; i < times; ++i) all.insert(all.end(), values.begin(), values.end());
  return all;
}

/// The bent grid with normals and tangents.
Builder with_tangents(int n) {
  Builder b = grid(n);
  const auto count = static_cast<std::size_t>((n + 1) * (n + 1));
  const std::size_t normals = b.add("VEC3", 5126, repeated({0, 0, 1}, count));
  const std::size_t tangents = b.add("VEC4", 5126, repeated({1, 0, 0, 1}, count));
  Json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] = normals;
  attributes["TANGENT"] = tangents;
  return b;
}

/// Columns: how a point of the face moves with U, and with V as it points upwards.
Eigen::Matrix<double, 3, 2> derivatives(const Face& face) {
  const auto& p = face.at("POSITION");
  const auto& uv = face.at("TEXCOORD_0");
  Eigen::Matrix<double, 3, 2> edges;
  Eigen::Matrix2d plane;
  for (int k = 0; k < 2; ++k) {
    const auto c = static_cast<std::size_t>(k + 1);
    edges.col(k) = vec3(p[c]) - vec3(p[0]);
    plane.col(k) = Vec2(uv[c][0] - uv[0][0], uv[0][1] - uv[c][1]);
  }
  return edges * plane.inverse();
}

/// Of a face whose corners are its own.
void expect_tangents_of(const Face& face) {
  const Eigen::Matrix<double, 3, 2> along = derivatives(face);
  const Vec3 normal(0, 0, 1);  // of every corner
  const auto& p = face.at("POSITION");
  const double turn = (vec3(p[1]) - vec3(p[0])).cross(vec3(p[2]) - vec3(p[0])).z();
  for (const std::vector<double>& tangent : face.at("TANGENT")) {
    const Vec3 t = vec3(tangent);
    const Vec3 expected = (along.col(0) - normal * normal.dot(along.col(0))).normalized();
    EXPECT_LT((t - expected).norm(), 1e-4);
    const Vec3 bitangent = tangent[3] * normal.cross(t) * (turn > 0 ? 1 : -1);
    EXPECT_GT(bitangent.dot(along.col(1)), 0);
  }
}

TEST(Tangents, OfSeparateFacesFollowTheirTextureCoordinates) {
  const Asset asset = read_file(with_tangents(6).glb());
  const std::string answer = write(asset, split_everywhere(asset), Format::glb);
  const auto read = read_naively(answer);
  ASSERT_EQ(read[0].faces.size(), 72U);
  for (const Face& face : read[0].faces) expect_tangents_of(face);
  const std::vector<Note> notes = side_effects(asset, split_everywhere(asset), Format::glb);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].text.find("computed again"), std::string::npos);
}

UnwrappedSurface flat_map(const Asset& asset, const std::vector<Vec2>& uv) {
  UnwrappedSurface unwrapped = split_nowhere(asset)[0];
  unwrapped.uv = uv;
  return unwrapped;
}

TEST(Tangents, AMirrorWithoutASeamSplitsItsVertices) {
  Builder b;  // two triangles over the edge 0-1, laid onto each other
  const std::size_t points = b.add("VEC3", 5126, {0, 0, 0, 0, 1, 0, 1, 0, 0, -1, 0, 0});
  const std::size_t normals = b.add("VEC3", 5126, repeated({0, 0, 1}, 4));
  const std::size_t tangents = b.add("VEC4", 5126, repeated({1, 0, 0, 1}, 4));
  const std::size_t corners = b.add("SCALAR", 5123, {0, 2, 1, 0, 1, 3});
  b.add_primitive({{"POSITION", points}, {"NORMAL", normals}, {"TANGENT", tangents}}, corners);
  const Asset asset = read_file(b.glb());
  const std::vector<UnwrappedSurface> folded = {
      flat_map(asset, {{0, 0}, {0, 1}, {1, 0}, {1, 0.5}})};
  const auto read = read_naively(write(asset, folded, Format::glb));
  for (const Face& face : read[0].faces) expect_tangents_of(face);
  EXPECT_EQ(vertex_maps(asset, folded, Format::glb)[0].copies.size(), 2U);
}

/// A bent sheet with smooth normals and texture coordinates that shear.
writer::TangentMesh sheet() {
  writer::TangentMesh mesh;
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k) {
      mesh.positions.emplace_back(i, k * 0.7, 0.05 * i * i - 0.1 * k * i);
      mesh.uv.emplace_back(0.1 * i + 0.02 * k * k, 0.1 * k + 0.01 * i);
      mesh.normals.push_back(Vec3(0.1 * k - 0.1 * i, 0.1 * i / 0.7, 1).normalized());
    }
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 5; ++k) {
      const Index a = 6 * i + k;
      mesh.faces.push_back({a, a + 6, a + 7});
      mesh.faces.push_back({a, a + 7, a + 1});
    }
  return mesh;
}

Vec3 projected(const Vec3& vector, const Vec3& normal) {
  return (vector - normal.dot(vector) * normal).normalized();
}

/// All triangles at a vertex, by their angles there as the normal sees them.
Vec3 weighted_mean(const writer::TangentMesh& mesh, Index vertex) {
  const auto at = [](const auto& values, Index i) { return values[static_cast<std::size_t>(i)]; };
  const Vec3 normal = at(mesh.normals, vertex);
  Vec3 sum = Vec3::Zero();
  for (const Triangle& face : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      if (face[k] != vertex) continue;
      const Index b = face[(k + 1) % 3], c = face[(k + 2) % 3];
      const Vec3 to_b = at(mesh.positions, b) - at(mesh.positions, vertex);
      const Vec3 to_c = at(mesh.positions, c) - at(mesh.positions, vertex);
      Eigen::Matrix<double, 3, 2> edges;
      edges << to_b, to_c;
      Eigen::Matrix2d plane;
      plane << at(mesh.uv, b) - at(mesh.uv, vertex), at(mesh.uv, c) - at(mesh.uv, vertex);
      const Vec3 along_u = (edges * plane.inverse()).col(0);
      const Vec3 flat_b = projected(to_b, normal), flat_c = projected(to_c, normal);
      sum +=
          std::atan2(flat_b.cross(flat_c).norm(), flat_b.dot(flat_c)) * projected(along_u, normal);
    }
  return sum.normalized();
}

TEST(Tangents, OfASmoothSheetAreMeansByAngles) {
  const writer::TangentMesh mesh = sheet();
  const auto tangents = writer::corner_tangents(mesh, {});
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const writer::Tangent& t = tangents[f][k];
      const Vec3 expected = weighted_mean(mesh, mesh.faces[f][k]);
      EXPECT_LT((Vec3(t[0], t[1], t[2]) - expected).norm(), 1e-5);
      EXPECT_EQ(t[3], 1);
    }
}

TEST(Tangents, DoNotDependOnHowVerticesAreShared) {
  const writer::TangentMesh mesh = sheet();
  writer::TangentMesh soup;
  for (const Triangle& face : mesh.faces) {
    const auto first = static_cast<Index>(soup.positions.size());
    soup.faces.push_back({first, first + 1, first + 2});
    for (const Index vertex : face) {
      soup.positions.push_back(mesh.positions[static_cast<std::size_t>(vertex)]);
      soup.normals.push_back(mesh.normals[static_cast<std::size_t>(vertex)]);
      soup.uv.push_back(mesh.uv[static_cast<std::size_t>(vertex)]);
    }
  }
  EXPECT_EQ(writer::corner_tangents(mesh, {}), writer::corner_tangents(soup, {}));
}

TEST(Tangents, AreUnitVectorsWhereTextureCoordinatesSayNothing) {
  writer::TangentMesh mesh = sheet();
  for (Vec2& uv : mesh.uv) uv = {0.5, 0.5};
  mesh.normals[3] = Vec3::Zero();
  for (const auto& face : writer::corner_tangents(mesh, {}))
    for (const writer::Tangent& t : face) EXPECT_NEAR(std::hypot(t[0], t[1], t[2]), 1, 1e-6);
}

}  // namespace
}  // namespace unwrapd::asset::test
