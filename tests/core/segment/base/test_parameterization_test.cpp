#include "core/segment/base/test_parameterization.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "core/linear/analysis.hpp"
#include "core/segment/base/failed_trials.hpp"
#include "tests/core/segment/cap_with_flap.hpp"
#include "tests/core/segment/segmentation_mesh_of.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment {
namespace {

Region all_of(const SegmentationMesh& surface) {
  Region region;
  for (Index t = 0; t < surface.face_count(); ++t) region.faces.push_back(t);
  region.uv = projected(surface, region.faces);
  return region;
}

/// A dome has a sound map of some distortion.
struct Dome {
  SegmentationMesh surface = segmentation_mesh_of(shapes::sphere_cap(12, 6, 1));
  Region region = all_of(surface);
  std::vector<char> open = std::vector<char>(surface.length.size(), 0);
};

/// Of half a grid: what its factor takes, vertices in the order of the sheet; in one of its own.
std::array<std::size_t, 2> panel_bytes_of_half(const SegmentationMesh& surface) {
  std::vector<std::pair<Index, Index>> sorted;
  for (Index v = 0; v < surface.mesh.vertex_count(); ++v)
    if (surface.mesh.positions[std::size_t(v)].x() <= 0)
      sorted.emplace_back(surface.rank[std::size_t(v)], v);
  std::ranges::sort(sorted);
  std::map<Index, Index> number;
  for (const auto& [rank, v] : sorted) number.emplace(v, static_cast<Index>(number.size()));
  std::vector<Triangle> faces;
  for (const Triangle& f : surface.mesh.faces)
    if (number.contains(f[0]) && number.contains(f[1]) && number.contains(f[2]))
      faces.push_back({number.at(f[0]), number.at(f[1]), number.at(f[2])});
  const std::vector<double> weight(3 * faces.size(), 1);
  const linear::SparseMatrix lower =
      linear::lower_laplacian(faces, static_cast<Index>(number.size()), weight);
  return {linear::analyse_in_order(lower)->panel_bytes(), linear::analyse(lower)->panel_bytes()};
}

TEST(SegmentationMesh, HasAnOrderOfEliminationThatSuitsItsParts) {
  SegmentationMesh surface = segmentation_mesh_of(shapes::grid(60, 60));
  const auto [own, best] = panel_bytes_of_half(surface);
  EXPECT_LT(own, best + best / 5);
  std::iota(surface.rank.begin(), surface.rank.end(), 0);
  EXPECT_GT(panel_bytes_of_half(surface)[0], best + best / 5)
      << "the test would see any order pass";
}

TEST(TestParameterization, LeavesAMapAsItIsAwayFromWhatIsAdded) {
  const CapWithFlap cap;
  Region near = cap.both, whole = cap.both;
  whole.mapped = 0;
  const TestRules rules{.most_excess = 1};
  const TestResult held = test_parameterization(cap.surface, {}, rules, near);
  const TestResult anew = test_parameterization(cap.surface, {}, rules, whole);
  ASSERT_EQ(held.verdict, Verdict::sound);
  ASSERT_EQ(anew.verdict, Verdict::sound);
  EXPECT_NEAR(held.excess.worst(), anew.excess.worst(), 0.05 * anew.excess.worst());
  EXPECT_EQ(near.mapped, 0U);
  const double scale = near.uv[0][0].norm() / cap.both.uv[0][0].norm();
  EXPECT_NEAR(scale, 1, 1e-3);
  std::size_t moved = 0, moved_anew = 0;
  for (std::size_t t = 0; t < cap.both.mapped; ++t) {
    const auto moves = [&](const Region& region) {
      return (region.uv[t][0] - scale * cap.both.uv[t][0]).norm() > 1e-12 ? 1 : 0;
    };
    moved += std::size_t(moves(near));
    moved_anew += std::size_t(moves(whole));
  }
  EXPECT_GT(moved, 10U);
  EXPECT_LE(moved, 100U);
  EXPECT_GT(moved_anew, cap.both.mapped * 9 / 10);
}

TEST(FailedTrials, KeepsFailuresAlone) {
  const Dome dome;
  FailedTrials memory;
  for (const auto& [most_excess, verdict] :
       {std::pair{1.0, Verdict::sound}, {1e-9, Verdict::distorted}}) {
    const TestRules rules{.most_excess = most_excess, .memory = &memory};
    const std::uint64_t key = trial_key(dome.open, rules, dome.region);
    Region region = dome.region;
    const TestResult first = test_parameterization(dome.surface, dome.open, rules, region);
    EXPECT_EQ(first.verdict, verdict);
    EXPECT_GT(first.excess.worst(), 1e-9);
    EXPECT_EQ(memory.find(key, most_excess).has_value(), verdict != Verdict::sound);
    Region again = dome.region;
    const TestResult second = test_parameterization(dome.surface, dome.open, rules, again);
    EXPECT_EQ(second.verdict, verdict);
    EXPECT_EQ(second.excess.angle, first.excess.angle);
    EXPECT_EQ(second.excess.area, first.excess.area);
    if (verdict == Verdict::sound) {
      EXPECT_EQ(again.uv, region.uv);
    }
  }
}

TEST(FailedTrials, AnswersInPlaceOfATrial) {
  const Dome dome;
  FailedTrials memory;
  const TestRules rules{.most_excess = 1, .memory = &memory};
  memory.keep(trial_key(dome.open, rules, dome.region), {Verdict::distorted, {3, 4}});
  Region region = dome.region;
  const TestResult result = test_parameterization(dome.surface, dome.open, rules, region);
  EXPECT_EQ(result.verdict, Verdict::distorted);
  EXPECT_EQ(result.excess.worst(), 4);
  const TestRules looser{.most_excess = 4, .memory = &memory};  // it would be within this
  EXPECT_EQ(test_parameterization(dome.surface, dome.open, looser, region).verdict, Verdict::sound);
}

TEST(FailedTrials, AnswerForAnyBoundWhereFlipsOrTopologyForbidAMap) {
  FailedTrials memory;
  memory.keep(1, {Verdict::flawed, {}});
  memory.keep(2, {Verdict::impossible, {}});
  EXPECT_TRUE(memory.find(1, 1e9));
  EXPECT_TRUE(memory.find(2, 1e9));
}

TEST(FailedTrials, KnowsWhatWasKnownBeforeAndWhatItTakes) {
  FailedTrials before, other;
  before.keep(1, {Verdict::distorted, {}});
  other.keep(2, {Verdict::distorted, {}});
  FailedTrials memory(&before);
  EXPECT_TRUE(memory.find(1, -1));
  EXPECT_FALSE(memory.find(2, -1));
  memory.take(std::move(other));
  EXPECT_TRUE(memory.find(2, -1));
  EXPECT_FALSE(before.find(2, -1)) << "others read it";
}

TEST(FailedTrials, TellsSetsApartByTheirFacesAndWhatIsGlued) {
  const Dome dome;
  const TestRules rules{.most_excess = 1};
  const std::uint64_t key = trial_key(dome.open, rules, dome.region);
  EXPECT_EQ(trial_key(dome.open, rules, dome.region), key);
  Region held = dome.region;
  held.mapped = 1;
  EXPECT_NE(trial_key(dome.open, rules, held), key) << "whose map stays in part may fail for that";
  EXPECT_EQ(trial_key({}, rules, dome.region), key);  // nothing is open either way
  EXPECT_NE(trial_key(dome.open, {.iterations = 5, .most_excess = 1}, dome.region), key);
  std::vector<char> slit = dome.open;
  slit[7] = 1;
  EXPECT_NE(trial_key(slit, rules, dome.region), key);
  Region moved = dome.region;
  moved.uv[3][1].x() += 1e-12;
  EXPECT_EQ(trial_key(dome.open, rules, moved), key);
  Region other = dome.region;
  std::swap(other.faces[0], other.faces[1]);
  EXPECT_EQ(trial_key(dome.open, rules, other), key);
  other.faces.pop_back();
  EXPECT_NE(trial_key(dome.open, rules, other), key);
}

}  // namespace
}  // namespace unwrapd::segment
