// Meshes that were written with rounding, face by face, with windings at random: they are unwrapped
// as the meshes that were meant.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/charts/repair_surfaces.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/pipeline/analyse.hpp"
#include "core/unwrap.hpp"
#include "tests/core/rounded.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using shapes::Rounded;

Unwrapped unwrapped(const TriMesh& mesh, const UnwrapOptions& options = {.effort = Effort::fast}) {
  SerialExecutor serial;
  return unwrap(std::vector{shapes::surface_of(mesh)}, options, {}, serial);
}

Index count_of(const std::vector<Repair>& repairs, RepairKind kind) {
  Index count = 0;
  for (const Repair& repair : repairs) count += repair.kind == kind ? repair.count : 0;
  return count;
}

double uv_area(const UnwrappedSurface& out, const Triangle& face) {
  const Vec2& a = out.uv[std::size_t(face[0])];
  const Vec2 ab = out.uv[std::size_t(face[1])] - a, ac = out.uv[std::size_t(face[2])] - a;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

void expect_as(const Report& clean, const Report& report, const std::string& name) {
  EXPECT_NEAR(report.distortion.angle, clean.distortion.angle, 0.01 * clean.distortion.angle)
      << name;
  EXPECT_NEAR(report.distortion.area, clean.distortion.area, 0.01 * clean.distortion.area) << name;
  EXPECT_EQ(report.distortion.flipped, 0) << name;
  EXPECT_EQ(report.input.components, clean.input.components) << name;
  EXPECT_EQ(report.input.genus, clean.input.genus) << name;
}

/// The soup with equal positions where it is welded, and with the winding of the exact mesh.
TriMesh meant(const Rounded& soup) {
  TriMesh mesh = soup.mesh;
  std::map<Index, Vec3> position;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    mesh.positions[v] = position.try_emplace(soup.exact[v], mesh.positions[v]).first->second;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t)
    if (soup.is_turned[t] != 0) std::swap(mesh.faces[t][1], mesh.faces[t][2]);
  return mesh;
}

/// The UVs of every corner, in the winding of the exact mesh.
std::vector<CornerUv> corners_of(const Unwrapped& out, const std::vector<char>& is_turned) {
  const UnwrappedSurface& surface = out.surfaces.front();
  std::vector<CornerUv> corners;
  for (std::size_t t = 0; t < surface.faces.size(); ++t) {
    CornerUv& corner = corners.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) corner[i] = surface.uv[std::size_t(surface.faces[t][i])];
    if (!is_turned.empty() && is_turned[t] != 0) std::swap(corner[1], corner[2]);
  }
  return corners;
}

/// The faces have the corners of the file, and exactly those that were turned are mirrored.
void expect_mirrored_where_turned(const Rounded& soup, const Unwrapped& out) {
  const UnwrappedSurface& surface = out.surfaces.front();
  Index mirrored = 0, as_wound = 0;
  for (std::size_t t = 0; t < surface.faces.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(surface.source[std::size_t(surface.faces[t][i])], soup.mesh.faces[t][i]);
    const bool is_mirrored = uv_area(surface, surface.faces[t]) < 0;
    mirrored += is_mirrored ? 1 : 0;
    as_wound += is_mirrored == (soup.is_turned[t] != 0) ? 1 : 0;
  }
  const auto count = Index(surface.faces.size());
  EXPECT_TRUE(as_wound == count || as_wound == 0) << as_wound << " of " << count;
  EXPECT_EQ(mirrored, count_of(out.report.repairs, RepairKind::faces_turned));
}

struct MeantMesh {
  std::string name;
  TriMesh mesh;
  bool is_closed;  ///< turned outward, as the mesh that was meant
};

std::vector<MeantMesh> meant_meshes() {
  return {{"sphere", shapes::sphere(2), true},
          {"cube", shapes::cube(1), true},
          {"torus", shapes::torus(16, 10), true},
          {"grid", shapes::grid(9, 7), false},
          {"cap", shapes::sphere_cap(24, 6), false}};
}

TEST(CarelessMesh, IsUnwrappedAsTheMeshThatWasMeant) {
  for (const auto& [name, mesh, is_closed] : meant_meshes()) {
    const Report clean = unwrapped(shapes::apart(mesh).mesh).report;
    for (const double noise : {1e-7, 1e-6}) {
      Rounded soup = shapes::rounded_soup(mesh, noise, 5);
      shapes::wind_at_random(0.5, 6, soup);
      const Unwrapped out = unwrapped(soup.mesh);
      expect_as(clean, out.report, name);
      expect_mirrored_where_turned(soup, out);
      EXPECT_EQ(count_of(out.report.repairs, RepairKind::vertices_welded_near),
                3 * mesh.face_count() - mesh.vertex_count());
      if (!is_closed) continue;
      EXPECT_EQ(corners_of(out, soup.is_turned), corners_of(unwrapped(meant(soup)), {})) << name;
    }
  }
}

TEST(CarelessMesh, IsLeftAsItIsWhereWeldIsExact) {
  const TriMesh mesh = shapes::sphere(1);
  const Rounded soup = shapes::rounded_soup(mesh, 1e-7, 5);
  const Unwrapped exact =
      unwrapped(soup.mesh, {.effort = Effort::fast, .welding = {.mode = WeldMode::exact}});
  EXPECT_EQ(exact.report.charts.size(), mesh.faces.size());
  const Welding welding{.mode = WeldMode::distance, .distance = 1e-5};
  EXPECT_LT(unwrapped(soup.mesh, {.effort = Effort::fast, .welding = welding}).report.charts.size(),
            10U);
}

TEST(CarelessMesh, IsAnalysedAsItIsUnwrapped) {
  Rounded soup = shapes::rounded_soup(shapes::torus(12, 8), 1e-7, 5);
  shapes::wind_at_random(0.2, 6, soup);
  const pipeline::InputAnalysis analysis =
      pipeline::analyse(std::vector{shapes::surface_of(soup.mesh)});
  EXPECT_EQ(analysis.input.components, 1);
  EXPECT_EQ(analysis.input.genus, 1);
  EXPECT_EQ(count_of(analysis.repairs, RepairKind::faces_turned),
            std::count(soup.is_turned.begin(), soup.is_turned.end(), 1));
}

/// A face without area leaves two open edges whose ends are near each other, and corners of a
/// needle that would collapse if they were welded.
TEST(CarelessMesh, HasNoRepairWhereNothingCanBeWelded) {
  const TriMesh mesh{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1 + 1e-6, 0, 0), Vec3(0, 1, 0),
                      Vec3(0, -1, 0), Vec3(1, 1, 0)},
                     {{0, 1, 3}, {2, 0, 4}, {0, 2, 1}, {1, 2, 5}}};
  const std::vector<Surface> surfaces{shapes::surface_of(mesh)};
  const Welding welding{.mode = WeldMode::distance, .distance = 1e-3};
  EXPECT_TRUE(charts::repair_surfaces(surfaces, welding).repairs.empty());
}

TEST(CarelessMesh, IsRefusedIfItIsOneSided) {
  Rounded soup = shapes::rounded_soup(shapes::mobius_strip(20), 1e-7, 5);
  shapes::wind_at_random(0.5, 6, soup);
  EXPECT_THROW(unwrapped(soup.mesh), Error);
}

TEST(CarelessMesh, NeedsAWeldDistanceWithItsMode) {
  const TriMesh mesh = shapes::grid(2, 2);
  EXPECT_THROW(unwrapped(mesh, {.welding = {.mode = WeldMode::distance}}), Error);
  EXPECT_THROW(unwrapped(mesh, {.welding = {.distance = 1.0}}), Error);
  EXPECT_THROW(unwrapped(mesh, {.welding = {WeldMode::distance, -1.0}}), Error);
  EXPECT_THROW(unwrapped(mesh, {.welding = {WeldMode::distance, std::nan("")}}), Error);
}

/// D_angle of Sec. 6 by the formula |J|^2 / det J, over the triangles of the mesh.
double angle_distortion(const TriMesh& mesh, const UnwrappedSurface& out) {
  double sum = 0, area = 0;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    const auto at = [&](std::size_t k) { return mesh.positions[std::size_t(mesh.faces[t][k])]; };
    const auto uv = [&](std::size_t k) { return out.uv[std::size_t(out.faces[t][k])]; };
    const Vec3 x = at(1) - at(0), y = at(2) - at(0);
    const Vec2 u = uv(1) - uv(0), v = uv(2) - uv(0);
    const double twice = x.cross(y).norm(), det = u.x() * v.y() - u.y() * v.x();
    const double norm = u.dot(u) * y.dot(y) - 2 * u.dot(v) * x.dot(y) + v.dot(v) * x.dot(x);
    sum += twice * norm / (twice * std::abs(det));
    area += twice;
  }
  return sum / area;
}

TEST(CarelessMesh, IsMeasuredWhereTheFileHasItsCorners) {
  const double noise = 0.02;
  const Rounded soup = shapes::rounded_soup(shapes::grid(5, 5), noise, 5);
  const double area = measure::surface_area(soup.mesh);
  const Welding welding{WeldMode::distance, 4 * noise * shapes::diagonal(soup.mesh)};
  const Unwrapped out =
      unwrapped(soup.mesh, {.max_distortion = 2.02, .effort = Effort::fast, .welding = welding});
  EXPECT_NEAR(out.report.distortion.angle, angle_distortion(soup.mesh, out.surfaces[0]), 1e-9);
  EXPECT_GT(out.report.distortion.angle, 2.021);
  EXPECT_NEAR(out.report.area, area, 1e-9 * area);
  ASSERT_FALSE(out.report.notes.empty());
  EXPECT_EQ(out.report.notes[0].code, NoteCode::distorted);
  EXPECT_NE(out.report.notes[0].text.find("weld_distance"), std::string::npos);
}

}  // namespace
}  // namespace unwrapd
