// Pages that are not square: padding, density and fill in texels along both axes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/page_grid.hpp"
#include "tests/core/outlines.hpp"

namespace unwrapd::pack {
namespace {

using shapes::pack_alone;
using shapes::polygon;
using shapes::square;
using shapes::stars;

/// The islands where they lie, in texels.
std::vector<charts::Outline> in_texels(std::vector<charts::Outline> islands,
                                       const PackResult& packed, int width) {
  for (std::size_t k = 0; k < islands.size(); ++k)
    for (auto& side : islands[k])
      for (Vec2& p : side) p = width * packed.placements[k](p);
  return islands;
}

double area_in_texels(const std::vector<charts::Outline>& islands) {
  double area = 0;
  for (const charts::Outline& island : islands) area += shapes::area(island);
  return area;
}

double fill(const std::vector<charts::Outline>& texels, const PageOptions& page) {
  return area_in_texels(texels) / page.resolution / page.height.value_or(page.resolution);
}

/// Every pair of islands, and every corner against the page's four edges.
void expect_padding(const std::vector<charts::Outline>& texels, const PageOptions& page) {
  const double least = page.padding - 1e-6;
  const Vec2 size(page.resolution, page.height.value_or(page.resolution));
  for (std::size_t i = 0; i < texels.size(); ++i) {
    for (const auto& [p, q] : texels[i]) {
      ASSERT_GE(p.minCoeff(), least) << i;
      ASSERT_GE((size - p).minCoeff(), least) << i;
    }
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE(shapes::gap(texels[i], texels[j]), least) << i << " and " << j;
  }
}

PageOptions page_of(int width, int height, int padding) {
  return {.resolution = width, .padding = padding, .height = height};
}

TEST(PageShape, TwoSquaresFillAPageTwiceAsLongAsWide) {
  const std::vector<charts::Outline> islands{square(3), square(3, {9, 9})};
  for (const PageOptions& page : {page_of(1024, 512, 0), page_of(256, 512, 0)}) {
    const auto texels = in_texels(islands, pack_alone(islands, page), page.resolution);
    EXPECT_GT(fill(texels, page), 0.9999);
    expect_padding(texels, page);
  }
}

TEST(PageShape, ARectangleOfThePagesShapeFillsItUpToThePadding) {
  const double padding = 8, width = 512, height = 128;
  const UvMap lying{{0, 0}, {width - 2 * padding, 0}, {0, height - 2 * padding}};
  for (const double angle : {0.0, 0.6, 1.5}) {
    const Vec2 u(std::cos(angle), std::sin(angle)), v(-u.y(), u.x());
    const std::vector<charts::Outline> islands{
        polygon({{0, 0}, lying[1].x() * u, lying[1].x() * u + lying[2].y() * v, lying[2].y() * v})};
    const PageOptions page = page_of(int(width), int(height), int(padding));
    const auto texels = in_texels(islands, pack_alone(islands, page), page.resolution);
    EXPECT_NEAR(area_in_texels(texels), lying[1].x() * lying[2].y(), 2);
    expect_padding(texels, page);
  }
}

struct Shape {
  int width = 0, height = 0, padding = 0;
};

class PageShapes : public testing::TestWithParam<Shape> {};

TEST_P(PageShapes, KeepThePaddingInTexelsAlongBothAxes) {
  const auto [width, height, padding] = GetParam();
  const PageOptions page = page_of(width, height, padding);
  for (const int count : {1, 2, 7, 60}) {  // few and many are packed in ways of their own
    const std::vector<charts::Outline> islands = stars(count, 11);
    const PackResult packed = pack_alone(islands, page);
    if (packed.padding < padding) continue;  // so many islands that it was reduced
    expect_padding(in_texels(islands, packed, width), page);
  }
}

TEST_P(PageShapes, KeepItOnSeveralPagesAndAtAGivenDensity) {
  const auto [width, height, padding] = GetParam();
  PageOptions page = page_of(width, height, padding);
  const std::vector<charts::Outline> islands = stars(12, 5);
  page.packing = {.max_pages = 3};
  const PackResult spread = pack_alone(islands, page);
  page.packing = {.texels_per_unit = 0.9 * spread.placements[0].scale * width, .max_pages = 9};
  const PackResult dense = pack_alone(islands, page);
  EXPECT_NEAR(dense.placements[0].scale * width, *page.packing.texels_per_unit, 1e-9);
  for (const PackResult& packed : {spread, dense})
    for (int k = 0; k < packed.pages; ++k) {
      std::vector<charts::Outline> on_page;
      for (charts::Outline island : in_texels(islands, packed, width)) {
        if (int(std::floor(island[0][0].x() / width)) != k) continue;
        for (auto& side : island)
          for (Vec2& p : side) p.x() -= k * width;
        on_page.push_back(std::move(island));
      }
      expect_padding(on_page, page);
    }
}

INSTANTIATE_TEST_SUITE_P(Pack, PageShapes,
                         testing::Values(Shape{1024, 512, 2}, Shape{300, 700, 3},
                                         Shape{2048, 128, 2}, Shape{64, 1024, 4},
                                         Shape{513, 512, 2}, Shape{256, 256, 3}),
                         [](const testing::TestParamInfo<Shape>& one) {
                           return std::to_string(one.param.width) + "x" +
                                  std::to_string(one.param.height);
                         });

TEST(PageShape, FillsNearlyAsMuchAsASquarePage) {
  for (const int count : {8, 80}) {
    const std::vector<charts::Outline> islands = stars(count, 3);
    const auto filled = [&](const PageOptions& page) {
      return fill(in_texels(islands, pack_alone(islands, page), page.resolution), page);
    };
    const double square = filled(page_of(1024, 1024, 2));
    EXPECT_GT(filled(page_of(1448, 724, 2)), 0.94 * square) << count;
    EXPECT_GT(filled(page_of(724, 1448, 2)), 0.94 * square) << count;
  }
}

TEST(PageShape, AnIslandThatIsLargerThanThePageIsRefused) {
  PageOptions page = page_of(1024, 64, 2);
  page.packing.texels_per_unit = 100.0;
  try {
    pack_alone(std::vector<charts::Outline>{square(1)}, page);
    ADD_FAILURE() << "it fits";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::does_not_fit);
  }
}

TEST(PageShape, ColumnsAndRowsAgree) {
  for (const double ratio : {1.0, 0.5, 2.0, 1.0 / 3, 0.001, 7.77, 511.0 / 512})
    for (int rows = 1; rows < 300; ++rows) {
      const int columns = columns_for(rows, ratio);
      EXPECT_GE(rows_of(columns, ratio), rows);
      EXPECT_TRUE(columns == 1 || rows_of(columns - 1, ratio) < rows);
    }
}

}  // namespace
}  // namespace unwrapd::pack
