#include "core/solve/base/align_constrained.hpp"

#include <gtest/gtest.h>

#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/holds_of.hpp"

namespace unwrapd::solve {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

TEST(Align, FindsTheSimilarityThatMovedTheMap) {
  const OwnedDisk d = disk_of(shapes::random_disk(6, 4));
  UvMap uv, moved;
  for (const Vec3& p : d.disk.positions) {
    uv.push_back(p.head<2>());
    moved.push_back(Vec2(2, 3) + 0.4 * Vec2(0.6 * p.x() - 0.8 * p.y(), 0.8 * p.x() + 0.6 * p.y()));
  }
  for (double weight : {1e-6, 1.0, 1e6}) {
    VertexConstraints constraints;
    for (Index v : {3, 9, 20}) constraints.hard.push_back({v, moved[std::size_t(v)]});
    for (Index v : {1, 30}) constraints.soft.push_back({v, moved[std::size_t(v)], weight});
    const Alignment a = align(uv, constraints);
    EXPECT_NEAR(a.scale, 0.4, 1e-12);
    EXPECT_LT(greatest_gap(constrained_start(uv, constraints), moved), 1e-12);
  }
}

TEST(Align, TurnsForLeastSquares) {
  const OwnedDisk d = disk_of(shapes::random_disk(6, 4));
  UvMap uv;
  for (const Vec3& p : d.disk.positions) uv.push_back(p.head<2>());
  VertexConstraints constraints{scattered(d.disk, 3, 1), {}};
  for (SoftConstraint& s : as_soft_constraints(scattered(d.disk, 9, 1), 0.3))
    if (s.vertex != constraints.hard[0].vertex && s.vertex != constraints.hard[1].vertex &&
        s.vertex != constraints.hard[2].vertex)
      constraints.soft.push_back(s);
  const auto error = [&](const Alignment& a) {
    double sum = 0;
    for (const HardConstraint& p : constraints.hard)
      sum += (a(uv[std::size_t(p.vertex)]) - p.at).squaredNorm();
    for (const SoftConstraint& s : constraints.soft)
      sum += 0.3 / 1.3 * (a(uv[std::size_t(s.vertex)]) - s.at).squaredNorm();
    return sum;
  };
  const Alignment best = align(uv, constraints);
  for (double angle : {-1e-5, 1e-5, 1.0, 3.0}) {
    Alignment other = best;
    other.cosine = best.cosine * std::cos(angle) - best.sine * std::sin(angle);
    other.sine = best.sine * std::cos(angle) + best.cosine * std::sin(angle);
    EXPECT_GT(error(other), error(best));
  }
  for (double shift : {-1e-5, 1e-5}) {
    Alignment other = best;
    other.to += Vec2(shift, shift);
    EXPECT_GT(error(other), error(best));
  }
}

}  // namespace
}  // namespace unwrapd::solve
