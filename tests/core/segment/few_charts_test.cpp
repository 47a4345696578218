// What max_charts comes to where no two of the last charts have a common map side by side.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/segment/base/merge.hpp"
#include "core/segment/map_anyhow.hpp"
#include "core/segment/settle_forced.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/core/segment/cut_up.hpp"
#include "tests/core/two_threads.hpp"
#include "tests/core/unwrapped_surface.hpp"

namespace unwrapd::segment {
namespace {

/// A star with six blunt arms.
TriMesh star(int levels) {
  TriMesh mesh = shapes::sphere(levels);
  for (Vec3& p : mesh.positions) {
    const double along = p.normalized().cwiseAbs().maxCoeff();
    p *= 0.3 + 1.2 * std::pow(along, 12);
  }
  return mesh;
}

UnwrapOptions bijective(Index most) {
  UnwrapOptions options;
  options.guarantee = Guarantee::bijective;
  options.max_distortion = 2.02;
  options.max_charts = most;
  return options;
}

double worst(const Distortion& d) { return std::max(d.angle, d.area); }

TriMesh shape_of(const std::string& name) {
  if (name == "sphere") return shapes::sphere(3);
  if (name == "star") return star(3);
  if (name == "torus") return shapes::torus(24, 12);
  return shapes::subdivided(shapes::pierced_bar(3));
}

class FewCharts : public testing::TestWithParam<std::string> {};

TEST_P(FewCharts, AreNoMoreThanAskedAndNoWorseThanACut) {
  const TriMesh mesh = shape_of(GetParam());
  const std::size_t wanted = faces_of(cut_up(mesh, {.max_distortion = 2.02})).size();
  ASSERT_GT(wanted, 1U);
  UnwrapOptions whole = bijective(1);
  whole.max_distortion.reset();
  const double cut = worst(unwrapped_surface(shapes::surface_of(mesh), whole).report.distortion);
  for (Index most = 1; most < std::min<Index>(static_cast<Index>(wanted), 5); ++most) {
    const Unwrapped few = unwrapped_surface(shapes::surface_of(mesh), bijective(most));
    EXPECT_LE(few.report.charts.size(), std::size_t(most));
    EXPECT_LE(worst(few.report.distortion), cut + 1e-3) << most;
    for (const ChartReport& chart : few.report.charts) {
      EXPECT_EQ(chart.distortion.flipped, 0);
      EXPECT_EQ(chart.overlaps, 0);
    }
    const Cut parts = cut_up(mesh, {.max_distortion = 2.02, .max_charts = most});
    for (const charts::Chart& chart : parts.surfaces.front().charts) expect_disk(chart);
    EXPECT_FALSE(parts.note.has_value());
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, FewCharts,
                         testing::Values("sphere", "star", "torus", "pierced_bar"),
                         [](const auto& shape) { return shape.param; });

/// A ball rolled out like the peel of an orange, not pressed flat.
TEST(FewCharts, StayWithinLittleDistortionWhereTheyCan) {
  const Unwrapped one = unwrapped_surface(shapes::surface_of(shapes::sphere(3)), bijective(1));
  EXPECT_EQ(one.report.charts.size(), 1U);
  EXPECT_LE(worst(one.report.distortion), 2.05);
}

/// The limit takes nothing from the bound where both can be had, and the order of seams holds.
TEST(FewCharts, HaveLessDistortionAndNoShorterSeamsForATighterBound) {
  int tightened = 0;
  for (const TriMesh& mesh : {shapes::torus(24, 12), star(3), shapes::sphere(3)}) {
    double last_seam = 0, last_worst = std::numeric_limits<double>::infinity();
    for (const double bound : {2.02, 2.01, 2.005}) {
      UnwrapOptions options = bijective(2);
      options.max_distortion = bound;
      const Report report = unwrapped_surface(shapes::surface_of(mesh), options).report;
      double seam = 0;
      for (const ChartReport& chart : report.charts) seam += chart.seam_length;
      EXPECT_LE(report.charts.size(), 2U);
      EXPECT_GE(seam, last_seam * (1 - 1e-9)) << bound;
      EXPECT_LE(worst(report.distortion), last_worst + 1e-3) << bound;
      tightened += worst(report.distortion) < last_worst - 1e-3 ? 1 : 0;
      last_seam = seam;
      last_worst = worst(report.distortion);
    }
  }
  EXPECT_GT(tightened, 3);  // all three have less distortion than infinitely much at first
}

/// Two halves of a ball meet along one ring: glued all along it, nothing is left to lay flat.
TEST(Force, HingesWhatWouldClose) {
  const TriMesh mesh = shapes::sphere(2);
  const SegmentationMesh surface =
      make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
  std::array<MappedRegion, 2> half;
  for (Index t = 0; t < surface.face_count(); ++t) {
    double z = 0;
    for (const Index v : surface.mesh.faces[std::size_t(t)])
      z += surface.mesh.positions[std::size_t(v)].z();
    half[z > 0 ? 0 : 1].faces.push_back(t);
  }
  for (MappedRegion& own : half) {
    own.uv = projected(surface, own.faces);
    ASSERT_EQ(test_parameterization(surface, {}, {.most_excess = 1}, own).verdict, Verdict::sound);
    own.area = 0.5;
  }
  const std::vector<char> open(surface.length.size(), 0);
  const Joiner joiner(surface);
  EXPECT_FALSE(joiner.join(half[0], half[1], open, 1, {}).region.is_sound);
  const auto map = [&](std::span<const char> cut, Region& region) {
    return map_anyhow(surface, cut, {}, region);
  };
  const Joined both = joiner.force(half[0], half[1], open, {.most_excess = 1}, map);
  EXPECT_EQ(both.verdict, Verdict::sound);
  EXPECT_EQ(both.region.faces.size(), std::size_t(surface.face_count()));
  EXPECT_TRUE(both.region.is_forced);
  std::vector<char> cut = open;
  for (const Index h : both.slit) cut[std::size_t(h)] = 1;
  const auto seam = RegionPair(surface, half[0], half[1]).border(open).size();
  EXPECT_LT(both.slit.size(), 2 * seam);
  half[1].is_forced = true;
  const RegionPair pair(surface, half[0], half[1]);
  EXPECT_TRUE(pair.place(pair.border(open)).both.is_forced);
  EXPECT_GT(both.slit.size(), 0U);
  for (const Index h : both.slit)
    EXPECT_EQ(cut[std::size_t(surface.halfedges.twin[std::size_t(h)])], 1);
}

/// Three balls want more charts than there are: none of these is left over.
TEST(FewCharts, AreAllSharedOut) {
  const std::vector<TriMesh> balls{shapes::sphere(3), moved(shapes::sphere(3), {5, 0, 0}),
                                   moved(star(3), {10, 0, 0})};
  const TriMesh mesh = shapes::merged(balls);
  const auto wanted = static_cast<Index>(faces_of(cut_up(mesh, {.max_distortion = 2.02})).size());
  ASSERT_GT(wanted, 6);
  for (Index most = 3; most <= wanted; ++most)
    EXPECT_EQ(faces_of(cut_up(mesh, {.max_distortion = 2.02, .max_charts = most})).size(),
              std::size_t(most));
}

/// Two small balls and a large one want as many charts each: the one that is left goes to the
/// large.
TEST(FewCharts, GoToTheLargestOfThoseThatWantAsMany) {
  const std::vector<TriMesh> balls{shapes::sphere(2), moved(shapes::sphere(2), {5, 0, 0}),
                                   moved(shapes::sphere(3), {10, 0, 0})};
  const Cut cut = cut_up(shapes::merged(balls), {.max_distortion = 2.02, .max_charts = 4});
  ASSERT_EQ(faces_of(cut).size(), 4U);
  const Index first_of_large = 2 * shapes::sphere(2).face_count();
  EXPECT_EQ(std::ranges::count_if(faces_of(cut),
                                  [&](const auto& faces) { return faces[0] >= first_of_large; }),
            2);
}

/// Sheets that want no second chart at 2.02 get none of those that are left at another bound.
TEST(FewCharts, AreNotGivenToWhatWantsNoMore) {
  const std::vector<TriMesh> sheets{shapes::grid(4, 4), moved(shapes::grid(4, 4), {5, 0, 0})};
  const TriMesh mesh = shapes::merged(sheets);
  EXPECT_EQ(faces_of(cut_up(mesh, {.max_distortion = 2.1, .max_charts = 50})).size(), 2U);
}

/// Blocks of an executor must not throw, whenever they are told to stop.
TEST(FewCharts, AreGivenUpInBlocksOfAnyThread) {
  charts::Charts whole = charts::components_of(shapes::surface_of(star(3)), {});
  TwoThreads two;
  for (const int patience : {1, 20, 60, 120, 200, 300, 400, 500}) {
    std::stop_source source;
    const std::jthread timer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(patience));
      source.request_stop();
    });
    std::vector<charts::Charts> surfaces{whole};
    try {
      segment_charts(surfaces, {.max_distortion = 2.02, .max_charts = 1}, {{}, source.get_token()},
                     two);
      EXPECT_EQ(surfaces.front().charts.size(), 1U);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
  }
}

/// Straight twigs along the axes, each from a place on an earlier one.
TriMesh tree_of_voxels(unsigned seed) {
  std::mt19937 draw(seed);
  std::set<std::array<int, 3>> cells{{0, 0, 0}};
  for (int twig = 0; twig < 40; ++twig) {
    std::array<int, 3> at = *std::next(cells.begin(), int(draw() % cells.size()));
    const std::size_t axis = draw() % 3;
    const int step = draw() % 2 == 0 ? 1 : -1;
    for (int k = 0; k < 7; ++k) at[axis] += step, cells.insert(at);
  }
  return shapes::voxel_surface(cells);
}

/// The limit may be missed where doubles have no map of a chart without overlaps; a note tells it.
/// None of these trees is such a case.
TEST(FewCharts, AreKeptToOrANoteTellsIt) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const Report report =
        unwrapped_surface(shapes::surface_of(tree_of_voxels(seed)), bijective(1)).report;
    ASSERT_EQ(report.input.components, 1);
    const bool is_noted = std::ranges::any_of(
        report.notes, [](const Note& note) { return note.code == NoteCode::charts_exceeded; });
    EXPECT_EQ(is_noted, report.charts.size() > 1) << seed;
    EXPECT_EQ(report.overlaps, 0);
  }
}

/// A map that lies on itself is no start for a chart.
TEST(SettleForced, FindsAMapWithoutOverlaps) {
  charts::Chart ball =
      charts::components_of(shapes::surface_of(shapes::sphere(2)), {}).charts.at(0);
  charts::Chart bag = ball;
  charts::cut(bag);
  bag.start.assign(bag.mesh.positions.size(), Vec2(0, 0));
  const auto settled = settle_forced(ball, {bag}, {});
  ASSERT_EQ(settled.size(), 1U);
  expect_disk(settled[0]);
  ASSERT_EQ(settled[0].start.size(), bag.start.size());
  expect_no_overlap(settled[0]);
}

}  // namespace
}  // namespace unwrapd::segment
