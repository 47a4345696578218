// Pages by material and by mesh, through the front door.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "core/base/error.hpp"
#include "core/measure/overlaps.hpp"
#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::pipeline {
namespace {

Unwrapped unwrapped(const std::vector<Surface>& surfaces, PageGroup group,
                    const UnwrapOptions& given = {}) {
  UnwrapOptions options = given;
  options.packing.group = group;
  options.guarantee = Guarantee::bijective;
  SerialExecutor serial;
  return unwrap(surfaces, options, {}, serial);
}

/// A ball whose faces have materials by the octant that they are in.
Surface patched_ball(int materials) {
  Surface ball = shapes::surface_of(shapes::sphere(2));
  for (std::size_t t = 0; t < ball.mesh.faces.size(); ++t) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : ball.mesh.faces[t]) middle += ball.mesh.positions[v];
    const int octant = (middle.x() > 0) + 2 * (middle.y() > 0) + 4 * (middle.z() > 0);
    ball.part[t] = octant % materials;
  }
  for (int m = 0; m < materials; ++m) ball.materials.push_back("m" + std::to_string(m));
  return ball;
}

/// The pages on which the faces of each group lie; every corner of a face is on one page.
std::map<std::string, std::set<int>> pages_by_material(const Surface& surface,
                                                       const UnwrappedSurface& out) {
  std::map<std::string, std::set<int>> pages;
  for (std::size_t t = 0; t < out.faces.size(); ++t)
    for (const Index v : out.faces[t])
      pages[surface.materials[surface.part[t]]].insert(int(std::floor(out.uv[v].x())));
  return pages;
}

TEST(PageGroups, EveryMaterialHasThePageThatTheReportNames) {
  for (const int count : {1, 2, 4}) {
    const Surface ball = patched_ball(count);
    const Unwrapped u = unwrapped({ball}, PageGroup::material);
    EXPECT_EQ(u.report.pages, count);
    ASSERT_EQ(u.report.page_names.size(), std::size_t(count));
    const auto pages = pages_by_material(ball, u.surfaces[0]);
    ASSERT_EQ(pages.size(), std::size_t(count));
    for (int page = 0; page < count; ++page)
      EXPECT_EQ(pages.at(u.report.page_names[std::size_t(page)]), std::set<int>{page});
    const UnwrappedSurface& s = u.surfaces[0];
    EXPECT_TRUE(measure::overlapping_pairs(s.faces, s.uv, 10).empty());
    EXPECT_EQ(u.report.distortion.flipped, 0);
  }
}

TEST(PageGroups, CopiesOfVerticesAtTheBorderOfMaterialsDoNotMatter) {
  Surface soup = patched_ball(2);
  const TriMesh apart = shapes::soup(soup.mesh);
  ASSERT_EQ(apart.faces.size(), soup.mesh.faces.size());
  soup.mesh = apart;
  const Unwrapped u = unwrapped({soup}, PageGroup::material, {.seams = SeamMode::none});
  for (const auto& [name, pages] : pages_by_material(soup, u.surfaces[0]))
    EXPECT_EQ(pages.size(), 1U) << name;
}

TEST(PageGroups, OneMaterialOfTwoMeshesIsOnePage) {
  Surface a = patched_ball(2), b = patched_ball(1);
  b.mesh = shapes::moved(b.mesh, {5, 0, 0});
  const Unwrapped u = unwrapped({a, b}, PageGroup::material);
  EXPECT_EQ(u.report.page_names.size(), 2U);  // m0 of both, and m1
  std::set<int> pages;
  for (const Vec2& uv : u.surfaces[1].uv) pages.insert(int(std::floor(uv.x())));
  EXPECT_EQ(pages.size(), 1U);
}

TEST(PageGroups, EveryMeshHasAPageAtOneDensity) {
  Surface a = shapes::surface_of(shapes::cube(1)), b = shapes::surface_of(shapes::sphere(1));
  a.name = "/meshes/0";
  b.name = "/meshes/1";
  for (Vec3& p : b.mesh.positions) p = 0.3 * p + Vec3(9, 0, 0);
  const Unwrapped u = unwrapped({a, b}, PageGroup::mesh);
  EXPECT_EQ(u.report.page_names, (std::vector<std::string>{"/meshes/0", "/meshes/1"}));
  for (int s = 0; s < 2; ++s)
    for (const Vec2& uv : u.surfaces[std::size_t(s)].uv) EXPECT_EQ(int(std::floor(uv.x())), s);
  EXPECT_LT(u.report.distortion.area, 2.03);  // after one scale for both
}

TEST(PageGroups, OfASceneHaveNoNamesAndOneGroupIsPackedAsTheScene) {
  Surface plain = patched_ball(3);
  plain.materials.clear();
  const Unwrapped scene = unwrapped({plain}, PageGroup::scene);
  EXPECT_TRUE(scene.report.page_names.empty());
  EXPECT_EQ(scene.report.pages, 1);
  EXPECT_EQ(unwrapped({plain}, PageGroup::material).surfaces[0].uv, scene.surfaces[0].uv);
}

TEST(PageGroups, OneGroupIsTold) {
  const auto is_told = [](const Unwrapped& u) {
    return std::ranges::any_of(u.report.notes, [](const Note& note) {
      return note.code == NoteCode::option_unused && note.text.starts_with("The option group=");
    });
  };
  for (const PageGroup group : {PageGroup::material, PageGroup::mesh})
    EXPECT_TRUE(is_told(unwrapped({patched_ball(1)}, group)));
  EXPECT_FALSE(is_told(unwrapped({patched_ball(1)}, PageGroup::scene)));
  EXPECT_FALSE(is_told(unwrapped({patched_ball(2)}, PageGroup::material)));
}

TEST(PageGroups, RepackedIslandsEndWhereMaterialsDo) {
  Surface sheet = shapes::surface_of(shapes::grid(4, 4));
  for (std::size_t t = 0; t < sheet.mesh.faces.size(); ++t) {
    CornerUv& uv = sheet.corner_uv.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      uv[i] = sheet.mesh.positions[sheet.mesh.faces[t][i]].head<2>();
    sheet.part[t] = t < sheet.mesh.faces.size() / 2 ? 0 : 1;
  }
  sheet.materials = {"a", "b"};
  SerialExecutor serial;
  const UnwrapOptions options{.packing = {.group = PageGroup::material}, .repack_only = true};
  const Unwrapped u = unwrap(std::vector{sheet}, options, {}, serial);
  for (const auto& [name, pages] : pages_by_material(sheet, u.surfaces[0]))
    EXPECT_EQ(pages.size(), 1U) << name;
  EXPECT_EQ(u.report.pages, 2);
}

TEST(PageGroups, MoreThanTenAreRefusedAndSoAreMorePages) {
  std::vector<Surface> many;
  for (int k = 0; k < 11; ++k) {
    many.push_back(shapes::surface_of(shapes::grid(1, 1)));
    many.back().name = "/meshes/" + std::to_string(k);
  }
  const auto refusal = [&](const UnwrapOptions& options) {
    try {
      unwrapped(many, PageGroup::mesh, options);
    } catch (const Error& error) {
      return std::pair(error.code(), error.where());
    }
    return std::pair(ErrorCode::internal, std::string());
  };
  EXPECT_EQ(refusal({}), std::pair(ErrorCode::does_not_fit, std::string("/group")));
  EXPECT_EQ(refusal({.packing = {.max_pages = 2}}),
            std::pair(ErrorCode::invalid_option, std::string("/max_pages")));
}

}  // namespace
}  // namespace unwrapd::pipeline
