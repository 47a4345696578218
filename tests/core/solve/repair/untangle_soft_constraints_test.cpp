// Springs while flips are turned back: the vertices they hold end in least squares, not anywhere.
#include <gtest/gtest.h>

#include "core/measure/energy.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "core/solve/repair/barrier.hpp"
#include "core/solve/repair/newton.hpp"
#include "core/solve/repair/untangle.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

constexpr double kTilt = 0.6, kPull = 5;

/// Four vertices drawn to where they lie in the map, turned and moved.
std::vector<SoftConstraint> soft_constraints_on(const UvMap& uv) {
  std::vector<SoftConstraint> soft;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t v = (2 * k + 1) * uv.size() / 8;
    const Vec2 at(std::cos(kTilt) * uv[v].x() - std::sin(kTilt) * uv[v].y() + 0.3,
                  std::sin(kTilt) * uv[v].x() + std::cos(kTilt) * uv[v].y() - 0.2);
    soft.push_back({Index(v), 1.1 * at, kPull});
  }
  return soft;
}

struct Sprung {
  OwnedDisk owned = disk_of(shapes::random_disk(12, 4));
  VertexConstraints constraints;
  UvMap uv;  ///< the least of ARAP's energy and the soft constraints'

  Sprung() {
    SerialExecutor serial;
    const UnwrapOptions options{.stop = {.tolerance = 1e-12}};
    const UvMap free = Solver(owned.disk, options, {}, serial).run(0, {}).uv;
    constraints.soft = soft_constraints_on(free);
    uv = Solver(owned.disk, options, {constraints, free}, serial).run(0, {}).uv;
  }
  [[nodiscard]] double energy(const UvMap& map) const {
    return measure::arap_energy(owned.disk.rest, owned.disk.faces, map) +
           soft_constraint_energy(constraints, map);
  }
  [[nodiscard]] MapIntent intent() const {
    return {.rigidity = {}, .constrained = {}, .stop = {}, .soft = constraints.soft};
  }
};

TEST(UntangleSprings, AVertexTornAwayReturnsToItsSpring) {
  const Sprung s;
  ASSERT_TRUE(measure::flipped_faces(s.owned.disk.faces, s.uv).empty());
  for (const SoftConstraint& soft_constraint : s.constraints.soft) {
    UvMap uv = s.uv;
    uv[std::size_t(soft_constraint.vertex)] += Vec2(0.16, 0.12);
    ASSERT_FALSE(measure::flipped_faces(s.owned.disk.faces, uv).empty());
    EXPECT_EQ(untangle(s.owned.disk, s.intent(), uv), 0);
    EXPECT_LT(s.energy(uv), 1.02 * s.energy(s.uv));
    const auto away = [&](const UvMap& map) {
      return (map[std::size_t(soft_constraint.vertex)] - soft_constraint.at).norm();
    };
    EXPECT_NEAR(away(uv), away(s.uv), 0.01);
  }
}

TEST(UntangleSprings, ANewMapComesToLieWhereTheyDrawIt) {
  const Sprung s;
  UvMap uv = s.uv;
  ASSERT_TRUE(start_anew(s.owned.disk, s.intent(), maps::tutte_map(s.owned.disk), uv));
  EXPECT_TRUE(measure::flipped_faces(s.owned.disk.faces, uv).empty());
  EXPECT_LT(s.energy(uv), 1.02 * s.energy(s.uv));
  for (const SoftConstraint& soft_constraint : s.constraints.soft) {
    const auto v = std::size_t(soft_constraint.vertex);
    EXPECT_LT((uv[v] - s.uv[v]).norm(), 0.02);
  }
}

TEST(UntangleSprings, TheModelHasTheirSlopeAndCurvature) {
  const Sprung s;
  std::vector<char> hard(s.uv.size(), 0);
  hard[std::size_t(s.constraints.soft[1].vertex)] = 1;  // a soft constraint there pulls at nothing
  const Disk& disk = s.owned.disk;
  const BarrierMesh mesh{{disk.faces.begin(), disk.faces.end()},
                         {disk.rest.begin(), disk.rest.end()},
                         linear::number_free(hard)};
  BarrierMesh sprung = mesh;
  sprung.soft = s.constraints.soft;
  Quadratic without = barrier_pattern(mesh), with = barrier_pattern(sprung);
  const Barrier barrier{{}, 0.1, 0};
  fill_barrier_model(mesh, s.uv, barrier, without);
  fill_barrier_model(sprung, s.uv, barrier, with);
  const Eigen::VectorXd slope = with.gradient - without.gradient;
  const Eigen::MatrixXd bend = Eigen::MatrixXd(with.hessian) - Eigen::MatrixXd(without.hessian);
  const double energy = barrier_energy(sprung, s.uv, barrier) - barrier_energy(mesh, s.uv, barrier);
  EXPECT_NEAR(energy, soft_constraint_energy(s.constraints, s.uv), 1e-12);
  Eigen::VectorXd expected_slope = Eigen::VectorXd::Zero(slope.size());
  Eigen::VectorXd expected_bend = Eigen::VectorXd::Zero(slope.size());
  for (const SoftConstraint& soft_constraint : s.constraints.soft) {
    const Index slot = mesh.free.slot[std::size_t(soft_constraint.vertex)];
    if (slot == linear::kFixed) continue;
    expected_slope.segment<2>(2 * slot) =
        2 * kPull * (s.uv[std::size_t(soft_constraint.vertex)] - soft_constraint.at);
    expected_bend.segment<2>(2 * slot).setConstant(2 * kPull);
  }
  EXPECT_LT((slope - expected_slope).norm(), 1e-10);
  EXPECT_LT((bend - Eigen::MatrixXd(expected_bend.asDiagonal())).norm(), 1e-9);
}

}  // namespace
}  // namespace unwrapd::solve::repair
