#include "core/charts/split_chart.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::charts {
namespace {

using shapes::disk_of;

bool is_one_disk(const Chart& chart) {
  const Topology shape = topology(chart.mesh.faces, chart.halfedges);
  return shape.components.size() == 1 && shape.components[0].is_disk();
}

TEST(SplitChart, KeepsEveryFaceOnceWithItsCornersInOrder) {
  for (const TriMesh& mesh : {shapes::grid(9, 7), shapes::annulus(20, 4), shapes::sphere_cap(14, 6),
                              shapes::random_disk(8, 4)}) {
    const auto owned = disk_of(mesh);
    const Chart& whole = *owned.chart;
    const auto parts = split_chart(
        whole, {std::vector{Index(0)}, std::vector{Index(1 + whole.mesh.face_count() / 2)}});
    ASSERT_GE(parts.size(), 2U);
    std::set<Index> seen;
    for (const ChartPart& part : parts) {
      EXPECT_TRUE(is_one_disk(part.chart));
      EXPECT_EQ(part.chart.halfedges.twin.size(), 3 * part.chart.mesh.faces.size());
      for (std::size_t t = 0; t < part.chart.mesh.faces.size(); ++t) {
        const Index source = part.chart.face_source[t];
        EXPECT_TRUE(seen.insert(source).second);
        const auto original =
            std::find(whole.face_source.begin(), whole.face_source.end(), source) -
            whole.face_source.begin();
        for (std::size_t i = 0; i < 3; ++i) {
          const Index own = part.chart.mesh.faces[t][i];
          EXPECT_EQ(part.vertex[std::size_t(own)], whole.mesh.faces[std::size_t(original)][i]);
          EXPECT_EQ(part.chart.mesh.positions[std::size_t(own)],
                    whole.mesh.positions[std::size_t(part.vertex[std::size_t(own)])]);
        }
      }
    }
    EXPECT_EQ(seen.size(), whole.mesh.faces.size());
  }
}

TEST(SplitChart, CutsHalfWayBetweenTheSeeds) {
  const auto owned = disk_of(shapes::grid(20, 3, 20, 3));
  const auto parts = split_chart(*owned.chart, {std::vector{Index(0)}, std::vector{Index(119)}});
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_NEAR(double(parts[0].chart.mesh.face_count()), 60, 4);
}

TEST(SplitChart, SeparatesTheSeeds) {
  const auto owned = disk_of(shapes::random_disk(6, 2));
  const std::vector<Index> a{0, 1, 2, 3}, b{40, 41, 50};
  const auto parts = split_chart(*owned.chart, {a, b});
  for (const ChartPart& part : parts) {
    std::set<Index> own(part.chart.face_source.begin(), part.chart.face_source.end());
    const auto has = [&](Index t) {
      return own.contains(owned.chart->face_source[std::size_t(t)]);
    };
    EXPECT_FALSE(std::any_of(a.begin(), a.end(), has) && std::any_of(b.begin(), b.end(), has));
  }
}

}  // namespace
}  // namespace unwrapd::charts
