// The page follows from the density.
#include "core/pipeline/fit_pages.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/core/outlines.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::pipeline {
namespace {

FittedPages fitted(const std::vector<charts::Outline>& islands, const Packing& packing,
                   PageFit fit = PageFit::multiple_of_four, int padding = 3) {
  const pack::PageOptions page{.padding = padding, .packing = packing, .effort = Effort::fast};
  return fit_pages(islands, page, fit,
                   [&](const pack::PageOptions& own) { return shapes::pack_alone(islands, own); });
}

/// Islands in texels, each on its page.
std::vector<charts::Outline> in_texels(const std::vector<charts::Outline>& islands,
                                       const FittedPages& on) {
  std::vector<charts::Outline> texels;
  for (std::size_t k = 0; k < islands.size(); ++k) {
    texels.push_back(shapes::placed(islands[k], on.packed.placements[k]));
    for (auto& side : texels.back())
      for (Vec2& p : side) p *= on.page.width;
  }
  return texels;
}

double least_gap(const std::vector<charts::Outline>& texels) {
  double least = 1e9;
  for (std::size_t k = 0; k < texels.size(); ++k)
    for (std::size_t j = 0; j < k; ++j) least = std::min(least, shapes::gap(texels[k], texels[j]));
  return least;
}

TEST(FitPages, TheDensityIsExactAndGapsAreAsWideAsThePadding) {
  for (unsigned seed = 0; seed < 3; ++seed)
    for (const double density : {20.0, 333.0}) {
      const auto islands = shapes::stars(4 + 3 * static_cast<int>(seed), seed);
      const FittedPages on = fitted(islands, {.texels_per_unit = density});
      const int side = on.page.width;
      EXPECT_EQ(on.page.height, side);
      EXPECT_EQ(side % 4, 0);
      EXPECT_EQ(on.packed.pages, 1);
      for (const pack::Placement& placement : on.packed.placements)
        EXPECT_NEAR(placement.scale * side / density, 1, 1e-12);
      const auto texels = in_texels(islands, on);
      EXPECT_GE(least_gap(texels), 3 - 1e-6) << seed << ", " << density;
      for (const charts::Outline& island : texels)
        for (const auto& [a, b] : island) {
          EXPECT_GE(a.minCoeff(), 3 - 1e-6);
          EXPECT_LE(a.maxCoeff(), side - 3 + 1e-6);
        }
    }
}

TEST(FitPages, NoPageOfMuchLessTexelsHoldsTheIslands) {  // as the same search fills a given page
  for (unsigned seed = 0; seed < 3; ++seed) {
    const auto islands = shapes::stars(12, seed);
    const pack::PageOptions page{.resolution = 1024, .padding = 3, .effort = Effort::fast};
    const double density = 1024 * shapes::pack_alone(islands, page).placements[0].scale;
    EXPECT_NEAR(fitted(islands, {.texels_per_unit = density}).page.width, 1024, 32);
  }
}

TEST(FitPages, APowerOfTwoIsTheNextAboveTheMultipleOfFour) {
  const auto islands = shapes::stars(7, 1);
  for (const double density : {50.0, 210.0}) {
    const int least = fitted(islands, {.texels_per_unit = density}).page.width;
    const FittedPages on = fitted(islands, {.texels_per_unit = density}, PageFit::power_of_two);
    const int side = on.page.width;
    EXPECT_TRUE(std::has_single_bit(static_cast<unsigned>(side)));
    EXPECT_GE(side, least);
    EXPECT_LT(side / 2, least);
    EXPECT_GE(least_gap(in_texels(islands, on)), 3 - 1e-6);
  }
}

TEST(FitPages, APageIsNeverTooSmallForItsPadding) {
  const std::vector<charts::Outline> one{shapes::square(1)};
  EXPECT_EQ(fitted(one, {.texels_per_unit = 1e-6}).page.width, kMinResolution);
  EXPECT_EQ(fitted(one, {.texels_per_unit = 1e-6}, PageFit::multiple_of_four, 30).page.width, 120);
  EXPECT_NEAR(fitted(one, {.texels_per_unit = 100.0}).page.width, 108, 4);
}

TEST(FitPages, KeepsThePaddingOfManyIslands) {  // which a page of the least size would reduce
  const std::vector<charts::Outline> islands(60, shapes::square(1));
  const FittedPages on = fitted(islands, {.texels_per_unit = 0.01});
  EXPECT_EQ(on.packed.padding, 3);
  EXPECT_GE(least_gap(in_texels(islands, on)), 3 - 1e-6);
}

TEST(FitPages, TakesMorePagesOnlyBeyondTheLargest) {
  const std::vector<charts::Outline> islands(4, shapes::square(1));
  const Packing packing{.texels_per_unit = 10000.0, .max_pages = 4};
  const FittedPages on = fitted(islands, packing);
  EXPECT_GT(on.packed.pages, 1);
  EXPECT_LE(on.page.width, kMaxResolution);
  EXPECT_EQ(fitted(islands, {.texels_per_unit = 1000.0, .max_pages = 4}).packed.pages, 1);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto island = shapes::placed(islands[k], on.packed.placements[k]);
    const double page = std::floor(island[0][0].x());
    for (const auto& [a, b] : island) EXPECT_EQ(std::floor(a.x()), page);
  }
  try {
    fitted(islands, {.texels_per_unit = 10000.0});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::does_not_fit);
    EXPECT_EQ(error.where(), "/texels_per_unit");
  }
}

TEST(FitPages, TheReportHasTheSizeAndTheDensity) {
  UnwrapOptions options{.page_fit = PageFit::multiple_of_four};
  options.packing.texels_per_unit = 77.0;
  SerialExecutor serial;
  const std::vector<Surface> surfaces{shapes::surface_of(shapes::cube(2))};
  const Report report = unwrap(surfaces, options, {}, serial).report;
  EXPECT_NEAR(report.texel_density, 77, 1e-3);
  EXPECT_NEAR(report.fill * report.page.width * report.page.width, 77.0 * 77 * report.area,
              0.02 * 77 * 77 * report.area);
  options.page_fit = PageFit::given;
  options.width = 2048;
  const PageSize given = unwrap(surfaces, options, {}, serial).report.page;
  EXPECT_EQ(given.width, 2048);
  EXPECT_EQ(given.height, 1024);
}

}  // namespace
}  // namespace unwrapd::pipeline
