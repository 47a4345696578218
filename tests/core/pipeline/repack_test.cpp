// UVs that are there, packed anew through the front door.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"

namespace unwrapd::pipeline {
namespace {

/// n separate quads, quad k at size 1 + k in space and 1 / (1 + k) in UV, the odd ones mirrored.
Surface quads(int n) {
  Surface surface{{}, {}, "quads"};
  for (Index k = 0; k < n; ++k) {
    const double size = 1 + k, uv = 1 / size;
    for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
      surface.mesh.positions.emplace_back(size * x, size * y, 10.0 * k);
    const auto corner = [&](int x, int y) { return Vec2((k % 2 == 0 ? uv : -uv) * x, uv * y); };
    surface.mesh.faces.push_back({4 * k, 4 * k + 1, 4 * k + 2});
    surface.corner_uv.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
    surface.mesh.faces.push_back({4 * k, 4 * k + 2, 4 * k + 3});
    surface.corner_uv.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
  }
  surface.part.assign(surface.mesh.faces.size(), 0);
  return surface;
}

Unwrapped repacked(const Surface& surface, const Packing& packing = {}) {
  SerialExecutor serial;
  return unwrap(std::span(&surface, 1),
                {.resolution = 256, .packing = packing, .repack_only = true}, {}, serial);
}

double side(const UnwrappedSurface& s, std::size_t face) {
  return (s.uv[std::size_t(s.faces[face][1])] - s.uv[std::size_t(s.faces[face][0])]).norm();
}

double signed_area(const UnwrappedSurface& s, std::size_t face) {
  const auto at = [&](int i) { return s.uv[std::size_t(s.faces[face][std::size_t(i)])]; };
  const Vec2 a = at(1) - at(0), b = at(2) - at(0);
  return (a.x() * b.y() - a.y() * b.x()) / 2;
}

TEST(Repack, KeepsShapesSidesAndSizesBesideEachOther) {
  const Unwrapped u = repacked(quads(4));
  const UnwrappedSurface& s = u.surfaces[0];
  EXPECT_EQ(u.report.charts.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(side(s, 2 * k) * double(1 + k), side(s, 0), 1e-6);
    EXPECT_GT(signed_area(s, 2 * k) * (k % 2 == 0 ? 1 : -1), 0) << "mirrored ones stay so";
  }
  EXPECT_GT(u.report.fill, 0.5);
}

TEST(Repack, WithoutRotationEverySideKeepsItsDirection) {
  Surface surface = quads(4);
  const double angle = 0.4;
  for (CornerUv& corners : surface.corner_uv)
    for (Vec2& uv : corners)
      uv = {std::cos(angle) * uv.x() - std::sin(angle) * uv.y(),
            std::sin(angle) * uv.x() + std::cos(angle) * uv.y()};
  const auto most_turned = [&](Rotation rotation) {
    const Unwrapped u = repacked(surface, {.rotation = rotation});
    const UnwrappedSurface& s = u.surfaces[0];
    double most = 0;
    for (std::size_t t = 0; t < s.faces.size(); ++t) {
      const Vec2 was = surface.corner_uv[t][1] - surface.corner_uv[t][0];
      const Vec2 is = s.uv[std::size_t(s.faces[t][1])] - s.uv[std::size_t(s.faces[t][0])];
      most = std::max(most, std::abs(was.x() * is.y() - was.y() * is.x()) / was.norm() / is.norm());
    }
    return most;
  };
  EXPECT_LT(most_turned(Rotation::none), 1e-6);
  EXPECT_NEAR(most_turned(Rotation::quarter), std::sin(angle), 1e-6);
}

TEST(Repack, GivesEveryIslandTheDensityThatIsAskedFor) {
  const Unwrapped u = repacked(quads(3), {.texels_per_unit = 20.0});
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(side(u.surfaces[0], 2 * k) * 256, 20.0 * double(1 + k), 1e-4);
  EXPECT_NEAR(u.report.texel_density, 20, 1e-3);
}

TEST(Repack, KeepsFacesTogetherThatShareCornersInSpaceAndPlane) {
  const Unwrapped u = repacked(quads(2));
  EXPECT_EQ(u.surfaces[0].source.size(), 8U);  // nothing is split
  EXPECT_EQ(u.report.seam_length, 0);
}

TEST(Repack, StacksMirroredQuadsOnlyOnTheirLike) {
  Surface surface = quads(4);
  for (std::size_t t = 0; t < surface.corner_uv.size(); ++t)
    for (Vec2& uv : surface.corner_uv[t]) uv *= double(1 + t / 2);  // all of one size
  const Unwrapped u = repacked(surface, {.stack_identical = true});
  EXPECT_EQ(u.report.notes.size(), 1U);
  EXPECT_GT(side(u.surfaces[0], 0), 0.4);
}

TEST(Repack, TellsThatIslandsOnAPointOrALineHaveNoArea) {
  for (const double height : {0.0, 0.1}) {
    Surface surface = quads(1);
    for (std::array<Vec2, 3>& corners : surface.corner_uv)
      for (Vec2& uv : corners) uv = Vec2(0.5, 0.25 + height * uv.y());
    const Report report = repacked(surface).report;
    EXPECT_GT(report.distortion.angle, 1000);
    EXPECT_EQ(report.distortion.flipped, 2);
    ASSERT_EQ(report.notes.size(), 1U);
    EXPECT_EQ(report.notes[0].code, NoteCode::distorted);
    EXPECT_TRUE(report.notes[0].text.starts_with("1 islands have no area"));
  }
  EXPECT_TRUE(repacked(quads(2)).report.notes.empty());
}

TEST(Repack, RefusesWhatHasNoUvs) {
  Surface surface = quads(2);
  surface.corner_uv.clear();
  try {
    repacked(surface);
    ADD_FAILURE() << "it was packed";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_texture_coordinates);
  }
}

/// A unit square as two triangles, whose UVs are at `low` and as wide as told.
void add_square(Surface& surface, const Vec2& low, double width) {
  const auto first = static_cast<Index>(surface.mesh.positions.size());
  CornerUv uv;
  const std::array<Vec2, 4> corners = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
  for (const Vec2& p : corners) surface.mesh.positions.emplace_back(p.x(), p.y(), 5.0 * first);
  for (const std::array<Index, 3>& face : {std::array<Index, 3>{0, 1, 2}, {0, 2, 3}}) {
    surface.mesh.faces.push_back({first + face[0], first + face[1], first + face[2]});
    for (std::size_t k = 0; k < 3; ++k)
      uv[k] = low + width * corners[static_cast<std::size_t>(face[k])];
    surface.corner_uv.push_back(uv);
  }
  surface.part.assign(surface.mesh.faces.size(), 0);
}

Unwrapped measured(const Surface& surface) {
  SerialExecutor serial;
  return unwrap(std::span(&surface, 1), {.measure_only = true}, {}, serial);
}

TEST(MeasureOnly, ChangesNothingAndTellsWhatIsThere) {
  Surface surface;
  add_square(surface, {0.1, 0.1}, 0.5);
  add_square(surface, {0.7, 0.1}, 0.25);
  const Unwrapped u = measured(surface);
  ASSERT_EQ(u.surfaces[0].faces.size(), 4U);
  for (std::size_t t = 0; t < 4; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(u.surfaces[0].uv[std::size_t(u.surfaces[0].faces[t][k])], surface.corner_uv[t][k]);
  EXPECT_EQ(u.report.charts.size(), 2U);
  EXPECT_NEAR(u.report.fill, 0.25 + 0.0625, 1e-12);
  EXPECT_EQ(u.report.overlaps, 0);
  EXPECT_NEAR(u.report.distortion.angle, 2, 1e-12);
  EXPECT_NEAR(u.report.charts[1].distortion.area, 2, 1e-12);  // each on its own scale
}

TEST(MeasureOnly, CountsOverlapsBetweenChartsAndTrianglesThatAreTurnedOver) {
  Surface surface;
  add_square(surface, {0.1, 0.1}, 0.5);
  add_square(surface, {0.1, 0.1}, 0.5);
  add_square(surface, {0.9, 0.1}, -0.25);  // overlaps nothing
  std::swap(surface.corner_uv[4][0], surface.corner_uv[4][1]);
  const Unwrapped u = measured(surface);
  EXPECT_EQ(u.report.distortion.flipped, 1);
  EXPECT_GE(*u.report.overlaps, 2);  // each triangle of the first lies on its like
}

TEST(MeasureOnly, CountsWhatLiesOnThePageAlone) {
  Surface surface;
  add_square(surface, {0.5, 0.5}, 1);
  EXPECT_NEAR(measured(surface).report.fill, 0.25, 1e-12);
}

TEST(MeasureOnly, RefusesWhatHasNoUvs) {
  Surface surface = quads(2);
  surface.corner_uv.clear();
  try {
    measured(surface);
    ADD_FAILURE() << "it was measured";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_texture_coordinates);
    EXPECT_EQ(error.where(), "/measure_only");
  }
}

TEST(Repack, TellsOfFacesWithoutUvs) {
  Surface surface = quads(2);
  surface.corner_uv[3][0] = Vec2(std::nan(""), 0);
  const Unwrapped u = repacked(surface);
  ASSERT_EQ(u.report.notes.size(), 1U);
  EXPECT_TRUE(u.report.notes[0].text.starts_with("1 faces"));
}

}  // namespace
}  // namespace unwrapd::pipeline
