// Torn maps, of which ARAP flips a tenth: their flips go at the price of a few solves.
#include "core/solve/repair/turn_over_all.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

std::size_t flip_count(const Disk& disk, const UvMap& uv) {
  return measure::flipped_faces(disk.faces, uv).size();
}

/// Counts what is handed to it: work without a clock. Large blocks and small ones count alike, so
/// that a sweep over the mesh counts by its size.
class BlockCounter final : public Executor {
 public:
  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    blocks += block_count;
    for (int block = 0; block < block_count; ++block) body(block);
  }
  int blocks = 0;
};

/// A disk as ARAP leaves it, at rest.
struct Torn {
  OwnedDisk owned;
  BlockCounter counter;
  Solver solver;
  UvMap uv;
  int solve_blocks;

  explicit Torn(TriMesh mesh, Method method = Method::arap, double lambda = 0)
      : owned(disk_of(std::move(mesh))),
        solver(disk(), UnwrapOptions{.method = method}, {}, counter),
        uv(solver.run(lambda, {}).uv),
        solve_blocks(counter.blocks) {}
  [[nodiscard]] const Disk& disk() const { return owned.disk; }
  [[nodiscard]] MapIntent intent() {
    MapIntent all{};
    all.executor = &counter;
    all.global = solver.global();
    return all;
  }
};

TriMesh rough_cap() { return shapes::noisy(shapes::sphere_cap(80, 60, 2.9), 0.3); }
TriMesh nearly_closed_cap() { return shapes::sphere_cap(80, 60, 3.1); }

TEST(TurnOverAll, LeavesAFewFlipsOfATornMapInAFewSteps) {
  for (const TriMesh& mesh : {rough_cap(), nearly_closed_cap()}) {
    Torn torn(mesh);
    const std::size_t before = flip_count(torn.disk(), torn.uv);
    ASSERT_GT(before, torn.disk().faces.size() / 20);
    UvMap uv = torn.uv;
    EXPECT_LE(turn_over_all(torn.disk(), torn.intent(), uv), 30);
    EXPECT_LE(flip_count(torn.disk(), uv), before / 50);
    const auto sums = [&](const UvMap& map) {
      return measure::distortion(
          measure::distortion_sums(torn.disk().rest, torn.disk().faces, map));
    };
    EXPECT_LT(sums(uv).angle, sums(torn.uv).angle);
  }
}

TEST(TurnOverAll, CostsUntanglingNoMoreThanTheSolve) {
  for (const TriMesh& mesh : {rough_cap(), nearly_closed_cap()}) {
    Torn torn(mesh);
    UvMap uv = torn.uv;
    EXPECT_EQ(untangle(torn.disk(), torn.intent(), uv), 0);
    EXPECT_LT(torn.counter.blocks - torn.solve_blocks, torn.solve_blocks);
  }
}

/// A job that may take what its faces and the factor of its solve take.
class TightCore final : public SharedCache {
 public:
  explicit TightCore(std::size_t bytes) : bytes_(bytes) {}
  [[nodiscard]] Digest digest(std::span<const std::byte>) const override { return {}; }
  std::shared_ptr<const void> obtain(const Digest&, const std::function<Made()>& make,
                                     const std::stop_token&) override {
    return make().value;
  }
  [[nodiscard]] std::size_t memory_limit() const override { return bytes_; }

 private:
  std::size_t bytes_;
};

TEST(TurnOverAll, TakesTheMemoryOfTheSolve) {
  Torn torn(rough_cap());
  constexpr std::size_t kFactorPerFace = 600;  // of the solve; Newton's on the whole takes 1,800
  TightCore core((kJobBytesPerFace + kFactorPerFace) * torn.disk().faces.size());
  Disk disk = torn.disk();
  disk.core = &core;
  UvMap uv = torn.uv;
  EXPECT_EQ(untangle(disk, {}, uv), 0);
}

TEST(Newton, FactorsNothingThatDoesNotFit) {
  const auto owned = disk_of(shapes::grid(60, 60));
  UvMap uv = shapes::from_above(owned.disk);
  Disk disk = owned.disk;
  TightCore core(kJobBytesPerFace * disk.faces.size() + 1000);
  disk.core = &core;
  try {
    start_anew(disk, {}, uv, uv);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::too_much_memory);
  }
}

TEST(TurnOverAll, GivesTheSameMapOnAnyThreads) {
  TwoThreads two;
  Torn torn(rough_cap());
  UvMap alone = torn.uv, abreast = torn.uv;
  turn_over_all(torn.disk(), {}, alone);
  MapIntent on_two{};
  on_two.executor = &two;
  turn_over_all(torn.disk(), on_two, abreast);
  EXPECT_EQ(alone, abreast);
  UvMap given = torn.uv;  // the solver's own factor
  turn_over_all(torn.disk(), torn.intent(), given);
  EXPECT_EQ(alone, given);
}

TEST(TurnOverAll, HardlyMovesAMapAtRestThatHasNoFlips) {
  Torn torn(shapes::sphere_cap(40, 30, 2));
  ASSERT_EQ(flip_count(torn.disk(), torn.uv), 0U);
  UvMap uv = torn.uv;
  turn_over_all(torn.disk(), torn.intent(), uv);
  EXPECT_EQ(flip_count(torn.disk(), uv), 0U);
  for (std::size_t v = 0; v < uv.size(); ++v) EXPECT_LT((uv[v] - torn.uv[v]).norm(), 2e-3);
}

TEST(TurnOverAll, TurnsMirroredAndFoldedMapsOver) {
  const auto owned = disk_of(shapes::grid(40, 40));
  for (double fold : {0.2, 0.5, 10.0}) {  // the last one mirrors all
    UvMap uv = shapes::from_above(owned.disk);
    for (Vec2& u : uv) {
      const double beyond = (2 * fold * 0.999 - u.x() - u.y()) / 2;
      if (beyond > 0) u += 2 * beyond * Vec2(1, 1);
    }
    const std::size_t before = flip_count(owned.disk, uv);
    EXPECT_LE(turn_over_all(owned.disk, {}, uv), kMostSplitSteps);
    EXPECT_LE(flip_count(owned.disk, uv), before / 50);
  }
}

TEST(TurnOverAll, MindsTheEnergyOfEveryRigidity) {
  for (const double lambda : {0.0, 1.0, 100.0}) {
    SCOPED_TRACE(lambda);
    Torn torn(shapes::sphere_cap(40, 30, 2), Method::hybrid, lambda);
    UvMap uv = shapes::shaken(torn.uv, 0.004, 3);
    const std::size_t before = flip_count(torn.disk(), uv);
    ASSERT_GT(before, torn.disk().faces.size() / 100);
    turn_over_all(torn.disk(), {.rigidity = {lambda}, .constrained = {}, .stop = {}}, uv);
    EXPECT_LE(flip_count(torn.disk(), uv), before / 50);
    const auto energy = [&](const UvMap& map) {
      double sum = 0;
      for (std::size_t t = 0; t < torn.disk().faces.size(); ++t) {
        const measure::RestTriangle& rest = torn.disk().rest[t];
        const measure::Jacobian j =
            measure::jacobian(rest, measure::uv_edges(torn.disk().faces[t], map));
        sum += arap::fit_energy(j, arap::fit_similarity(j, lambda), rest.area, lambda);
      }
      return sum;
    };
    EXPECT_LT(energy(uv), energy(torn.uv) + 0.05);
  }
}

TEST(TurnOverAll, LeavesHeldVerticesAndHearsSprings) {
  const Torn torn(rough_cap());
  const Vec2 aside(0.05, -0.03);
  MapIntent intent{.rigidity = {}, .constrained = std::vector<char>(torn.uv.size(), 0), .stop = {}};
  for (std::size_t v = 7; v < torn.uv.size(); v += 601) intent.constrained[v] = 1;
  intent.soft = {{11, torn.uv[11] + aside, 50}};
  UvMap uv = torn.uv;
  turn_over_all(torn.disk(), intent, uv);
  for (std::size_t v = 0; v < uv.size(); ++v)
    EXPECT_TRUE(intent.constrained[v] == 0 || uv[v] == torn.uv[v]) << v;
  EXPECT_LT((uv[11] - intent.soft[0].at).norm(), 0.2 * aside.norm());
}

TEST(TurnOverAll, StopsWhenAsked) {
  Torn torn(rough_cap());
  std::stop_source stop;
  stop.request_stop();
  UvMap uv = torn.uv;
  EXPECT_THROW(
      turn_over_all(torn.disk(), {.rigidity = {}, .constrained = {}, .stop = stop.get_token()}, uv),
      Error);
}

}  // namespace
}  // namespace unwrapd::solve::repair
