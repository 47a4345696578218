#include "core/charts/shortest_seam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/charts/split_chart.hpp"
#include "core/mesh/edges.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::charts {
namespace {

using shapes::disk_of;
using Sets = std::array<std::vector<Index>, 2>;

double length_of(const Chart& chart, const Halfedges& cut) {
  double length = 0;
  for (std::size_t h = 0; h < cut.twin.size(); ++h)
    if (cut.twin[h] != chart.halfedges.twin[h])
      length += (chart.mesh.positions[end_of(chart.mesh.faces, Index(h))] -
                 chart.mesh.positions[start_of(chart.mesh.faces, Index(h))])
                    .norm() /
                2;
  return length;
}

bool separates(const Chart& chart, const Halfedges& cut, const Sets& sets) {
  for (const ChartPart& part : parts_of(chart, cut)) {
    const auto has = [&](Index t) { return std::ranges::find(part.face, t) != part.face.end(); };
    if (std::ranges::any_of(sets[0], has) && std::ranges::any_of(sets[1], has)) return false;
  }
  return true;
}

/// Two squares and a neck between them, which is a third as wide.
TriMesh dumbbell() {
  return shapes::mapped_grid(30, 6, shapes::Wrap::none, [](double u, double v) {
    const double width = 2 - 1.5 * std::exp(-80 * (u - .4) * (u - .4));
    return Vec3(10 * u, width * (v - .5), 0);
  });
}

TEST(ShortestSeam, CutsANeck) {
  const auto owned = disk_of(dumbbell());
  const Chart& chart = *owned.chart;
  const Sets sets{std::vector{Index(0), Index(1)}, std::vector{chart.mesh.face_count() - 1}};
  const Halfedges cut = cut_between(chart, sets);
  EXPECT_TRUE(separates(chart, cut, sets));
  EXPECT_LT(length_of(chart, cut), 0.56);  // the neck is half a unit wide where it is narrowest
  EXPECT_EQ(parts_of(chart, cut).size(), 2U);
}

TEST(ShortestSeam, GoesAroundACornerIfThatIsShorter) {
  const auto owned = disk_of(shapes::grid(20, 5, 20, 5));
  const Sets sets{std::vector{Index(0)}, std::vector{owned.chart->mesh.face_count() - 1}};
  const Halfedges cut = cut_between(*owned.chart, sets);
  EXPECT_TRUE(separates(*owned.chart, cut, sets));
  EXPECT_LE(length_of(*owned.chart, cut), 2 + 1e-9);  // around the corner's triangle alone
}

/// The least length of all ways to put the faces on two sides.
double least_of_all(const Chart& chart, const Sets& sets) {
  std::vector<std::array<Index, 2>> sides;
  std::vector<double> length;
  for (Index h = 0; h < Index(chart.halfedges.twin.size()); ++h) {
    const Index twin = chart.halfedges.twin[std::size_t(h)];
    if (twin < h) continue;
    sides.push_back({h / 3, twin / 3});
    length.push_back((chart.mesh.positions[std::size_t(end_of(chart.mesh.faces, h))] -
                      chart.mesh.positions[std::size_t(start_of(chart.mesh.faces, h))])
                         .norm());
  }
  double least = 1e9;
  for (unsigned first = 0; first < 1U << unsigned(chart.mesh.face_count()); ++first) {
    const auto is_first = [&](Index t) { return (first >> unsigned(t) & 1U) != 0; };
    if (!std::ranges::all_of(sets[0], is_first) || std::ranges::any_of(sets[1], is_first)) continue;
    double own = 0;
    for (std::size_t k = 0; k < sides.size(); ++k)
      if (is_first(sides[k][0]) != is_first(sides[k][1])) own += length[k];
    least = std::min(least, own);
  }
  return least;
}

TEST(ShortestSeam, IsTheShortestOfAllOnSmallCharts) {
  std::mt19937 random(7);
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    const auto owned = disk_of(shapes::random_disk(3, seed));
    Sets sets;
    for (Index t = 0; t < owned.chart->mesh.face_count(); ++t)
      if (const auto side = random() % 8; side < 2) sets[side].push_back(t);
    if (sets[0].empty() || sets[1].empty()) continue;
    const double least = least_of_all(*owned.chart, sets);
    EXPECT_NEAR(length_of(*owned.chart, cut_between(*owned.chart, sets)), least, 0.01 * least);
  }
}

TEST(ShortestSeam, SeparatesAnySetsAndIsNoLongerThanOthers) {
  std::mt19937 random(3);
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const auto owned =
        disk_of(seed % 2 == 0 ? shapes::random_disk(9, seed) : shapes::annulus(24, 5));
    const Chart& chart = *owned.chart;
    const auto drawn = [&] { return Index(random() % unsigned(chart.mesh.face_count())); };
    Sets sets{std::vector{drawn()}, {}};
    for (int k = 0; k < 4; ++k) {
      const Index t = drawn();
      if (t != sets[0].front()) sets[1].push_back(t);
    }
    const Halfedges cut = cut_between(chart, sets);
    EXPECT_TRUE(separates(chart, cut, sets));
    Halfedges half_way = chart.halfedges, around = chart.halfedges;
    const auto parts = split_chart(chart, sets);
    std::vector<Index> of(chart.mesh.faces.size(), 0);
    for (std::size_t p = 0; p < parts.size(); ++p)
      for (const Index t : parts[p].face) of[std::size_t(t)] = Index(p);
    for (std::size_t h = 0; h < half_way.twin.size(); ++h) {
      const Index twin = chart.halfedges.twin[h];
      if (twin == kNoTwin) continue;
      if (of[std::size_t(twin / 3)] != of[h / 3]) half_way.twin[h] = kNoTwin;
      if (Index(h) / 3 == sets[0].front() || twin / 3 == sets[0].front()) around.twin[h] = kNoTwin;
    }
    const double slack = 1.01;  // lengths are rounded
    EXPECT_LE(length_of(chart, cut), slack * length_of(chart, half_way));
    EXPECT_LE(length_of(chart, cut), slack * length_of(chart, around));
  }
}

}  // namespace
}  // namespace unwrapd::charts
