#include "core/pack/pack_groups.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.hpp"
#include "tests/core/outlines.hpp"

namespace unwrapd::pack {
namespace {

using shapes::polygon;
using shapes::square;
using shapes::stars;

PackResult grouped(const std::vector<charts::Outline>& islands, const std::vector<Index>& group,
                   const PageOptions& page = {}) {
  SerialExecutor serial;
  JobExecutor job(serial, {});
  return pack_groups(islands, group, page, job);
}

/// Each corner on the page of its group, at the padding from its border, at one density.
void expect_own_pages(const std::vector<charts::Outline>& islands, const std::vector<Index>& group,
                      const PackResult& packed, const PageOptions& page) {
  const double padding = packed.padding / page.resolution - 1e-12;
  for (std::size_t k = 0; k < islands.size(); ++k) {
    EXPECT_NEAR(packed.placements[k].scale / packed.placements[0].scale, 1, 1e-12);
    for (const auto& [p, q] : islands[k]) {
      const Vec2 at = packed.placements[k](p) - Vec2(group[k], 0);
      EXPECT_GE(at.minCoeff(), padding);
      EXPECT_LE(at.x(), 1 - padding);
      EXPECT_LE(at.y(), page.aspect() - padding);
    }
  }
}

TEST(PackGroups, EveryGroupHasItsPageAndAllHaveOneDensity) {
  const std::vector<charts::Outline> islands = stars(24, 7);
  std::vector<Index> group;
  for (Index k = 0; k < 24; ++k) group.push_back(k < 15 ? 2 : k % 2);  // 15, 5 and 4
  for (const PageOptions& page :
       {PageOptions{}, PageOptions{.resolution = 512, .padding = 4, .height = 256}}) {
    const PackResult packed = grouped(islands, group, page);
    EXPECT_EQ(packed.pages, 3);
    expect_own_pages(islands, group, packed, page);
    const double least = page.padding / double(page.resolution) - 1e-9;
    for (std::size_t i = 0; i < islands.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_GE(shapes::gap(shapes::placed(islands[i], packed.placements[i]),
                              shapes::placed(islands[j], packed.placements[j])),
                  least);
  }
}

TEST(PackGroups, TheFullestPageDeterminesTheDensity) {
  const std::vector<charts::Outline> islands{square(1), square(3), square(0.1)};
  const PackResult packed = grouped(islands, {0, 1, 2}, {.resolution = 1024, .padding = 8});
  EXPECT_NEAR(packed.placements[0].scale, (1 - 16.0 / 1024) / 3, 1e-6);
}

TEST(PackGroups, LongIslandsFillLongPages) {
  const charts::Outline strip = polygon({{0, 0}, {3, 0}, {3, 1}, {0, 1}}),
                        shorter = polygon({{0, 0}, {2.9, 0}, {2.9, 1}, {0, 1}});
  for (const int height : {512, 2048}) {  // strips of at most a third of the longer side
    const PageOptions page{.resolution = 1024, .padding = 2, .height = height};
    const double most = std::max(1.0, page.aspect()) / 3;
    EXPECT_GT(grouped({strip, strip}, {0, 1}, page).placements[0].scale, 0.99 * most);
    EXPECT_GT(grouped({strip, shorter}, {0, 1}, page).placements[0].scale, 0.96 * most);
  }
}

TEST(PackGroups, OneGroupIsPackedAsWithoutGroups) {
  const std::vector<charts::Outline> islands = stars(9, 2);
  const PackResult packed = grouped(islands, std::vector<Index>(9, 0)),
                   plain = shapes::pack_alone(islands);
  for (std::size_t k = 0; k < islands.size(); ++k)
    EXPECT_EQ(packed.placements[k].offset, plain.placements[k].offset);
}

TEST(PackGroups, NearlyEqualGroupsFillTheirPages) {
  std::vector<charts::Outline> islands;
  std::vector<Index> group;
  for (Index g = 0; g < 4; ++g)
    for (charts::Outline& island : stars(10, 40 + static_cast<unsigned>(g))) {
      islands.push_back(std::move(island));
      group.push_back(g);
    }
  double least = 1;
  for (Index g = 0; g < 4; ++g) {
    const std::vector<charts::Outline> own(islands.begin() + 10 * g, islands.begin() + 10 * g + 10);
    least = std::min(least, shapes::pack_alone(own).placements[0].scale);
  }
  const PackResult packed = grouped(islands, group);
  expect_own_pages(islands, group, packed, {});
  EXPECT_LE(packed.placements[0].scale, least);
  EXPECT_GT(packed.placements[0].scale, 0.85 * least);
}

TEST(PackGroups, IslandsWithoutExtentDoNotShrinkTheOthers) {
  const std::vector<charts::Outline> islands{square(1), polygon({{3, 3}, {3, 3}})};
  EXPECT_GT(grouped(islands, {0, 1}).placements[0].scale, 0.9);
}

TEST(PackGroups, KeepAGivenDensityOrRefuseIt) {
  const std::vector<charts::Outline> islands{square(1), square(2)};
  PageOptions page{.packing = {.texels_per_unit = 200.0}};
  for (const Placement& placement : grouped(islands, {0, 1}, page).placements)
    EXPECT_NEAR(placement.scale * 1024, 200, 1e-9);
  page.packing.texels_per_unit = 600.0;
  EXPECT_THROW(grouped(islands, {0, 1}, page), Error);
}

TEST(PackGroups, StackOnlyWithinAGroup) {
  const std::vector<charts::Outline> islands{square(1), square(1), square(1)};
  const PackResult packed = grouped(islands, {0, 1, 1}, {.packing = {.stack_identical = true}});
  EXPECT_EQ(std::ranges::count(packed.is_stacked, 1), 1);
  EXPECT_EQ(packed.is_stacked[0], 0);
}

}  // namespace
}  // namespace unwrapd::pack
