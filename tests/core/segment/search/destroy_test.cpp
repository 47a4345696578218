#include "core/segment/search/destroy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/base/error.hpp"
#include "tests/core/segment/segmentation_mesh_of.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment::search {
namespace {

/// Regions of `size` faces each, as they follow each other; the seams inside are all marked `open`.
Partition in_rows(const SegmentationMesh& surface, Index size, char open) {
  Partition partition{{}, std::vector<char>(surface.length.size(), open)};
  for (Index t = 0; t < surface.face_count(); ++t) {
    if (t % size == 0) partition.regions.emplace_back();
    MappedRegion& region = partition.regions.back();
    region.faces.push_back(t);
    region.area += surface.area(t);
  }
  for (MappedRegion& region : partition.regions) {
    region.uv = projected(surface, region.faces);
    region.is_sound = true;
  }
  return partition;
}

std::set<std::vector<Index>> face_sets(std::span<const MappedRegion> regions) {
  std::set<std::vector<Index>> sets;
  for (const MappedRegion& region : regions) sets.insert(region.faces);
  return sets;
}

TEST(Destroy, PartsFallBackToTheirFirstRegionsAndTheRestStaysWhole) {
  const SegmentationMesh surface = segmentation_mesh_of(shapes::sphere(3));
  const Partition from = in_rows(surface, 4, 0), merged = in_rows(surface, 64, 1);
  std::set<std::set<std::vector<Index>>> kinds;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Destroyed loose = destroy(surface, from, merged, seed);
    const auto& regions = loose.partition.regions;
    const auto count = static_cast<std::size_t>(loose.whole);
    ASSERT_LT(count, merged.regions.size());
    const auto whole = face_sets(std::span(regions).first(count));
    const auto parts = face_sets(std::span(regions).subspan(count));
    EXPECT_TRUE(std::ranges::includes(face_sets(merged.regions), whole));
    EXPECT_TRUE(std::ranges::includes(face_sets(from.regions), parts));
    std::vector<int> owned(surface.mesh.faces.size(), 0);
    double area = 0;
    for (std::size_t k = 0; k < regions.size(); ++k)
      for (const Index t : regions[k].faces) {
        ++owned[t];
        if (k >= count) area += surface.area(t);
        EXPECT_EQ(loose.partition.open[3 * t], k < count ? 1 : 0);
      }
    EXPECT_EQ(std::ranges::count(owned, 1), surface.face_count());
    EXPECT_LE(area, 0.4);
    EXPECT_EQ(face_sets(destroy(surface, from, merged, seed).partition.regions),
              face_sets(regions));
    kinds.insert(parts);
  }
  EXPECT_GT(kinds.size(), 4);
}

TEST(Destroy, TakesApartTheLargeRatherThanTheSmall) {
  const SegmentationMesh surface = segmentation_mesh_of(shapes::sphere(3));
  const Partition from = in_rows(surface, 4, 0);
  Partition merged = in_rows(surface, 4, 1);
  for (std::size_t half = merged.regions.size() / 2; merged.regions.size() > half;) {
    const MappedRegion last = std::move(merged.regions.back());
    merged.regions.pop_back();
    Region& large = merged.regions.front();
    large.faces.insert(large.faces.end(), last.faces.begin(), last.faces.end());
    large.uv.insert(large.uv.end(), last.uv.begin(), last.uv.end());
    merged.regions.front().area += last.area;
  }
  const auto small = static_cast<Index>(merged.regions.size()) - 1;
  int large_ones = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Destroyed loose = destroy(surface, from, merged, seed);
    const auto whole = std::span(loose.partition.regions).first(std::size_t(loose.whole));
    large_ones += std::ranges::none_of(whole, [](const MappedRegion& p) { return p.area > 0.4; });
  }
  EXPECT_GT(large_ones, 10) << "of 40, by area 20; by number one of " << small + 1;
}

TEST(Merge, LeavesAloneWhatShallStayWhole) {
  const SegmentationMesh surface = segmentation_mesh_of(shapes::grid(8, 8));
  const Partition from = in_rows(surface, 2, 0);
  const auto all = static_cast<Index>(from.regions.size());
  SerialExecutor serial;
  const auto merged = [&](Index whole) {
    return merge_regions({surface}, Joiner(surface), from, {.budget = 1, .cap = 1, .whole = whole},
                         serial);
  };
  EXPECT_EQ(merged(all).regions.size(), from.regions.size());
  EXPECT_EQ(merged(0).regions.size(), 1);
  EXPECT_EQ(merged(all - 1).regions.size(), 1);  // by way of the last
}

}  // namespace
}  // namespace unwrapd::segment::search
