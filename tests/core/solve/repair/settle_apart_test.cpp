// Injective maps, by their own energies and an exact test.
#include "core/solve/repair/settle_apart.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "core/solve/maps/fill_holes.hpp"
#include "core/solve/repair/injective_step.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double energy_of(const Disk& disk, const UvMap& uv, double lambda) {
  double energy = 0;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    const measure::Jacobian j =
        measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv));
    energy += arap::fit_energy(j, arap::fit_similarity(j, lambda), disk.rest[t].area, lambda);
  }
  return energy;
}

bool is_injective(const Disk& disk, const UvMap& uv) {
  return measure::is_plainly_injective(disk.faces, disk.loops, uv);
}

UvMap start_of(const Disk& disk) {
  UvMap uv = maps::tutte_map(maps::fill_holes(disk).disk);
  uv.resize(disk.positions.size());
  const double scale = methods::best_scale(disk, uv);
  for (Vec2& u : uv) u *= scale;
  return uv;
}

TEST(SettleApart, LowersEveryEnergyAndStaysInjective) {
  for (const TriMesh& mesh : {shapes::pierced_disk(12, 5), shapes::sphere_cap(24, 10, 2),
                              shapes::spiral(40, 1), shapes::random_disk(9, 4)})
    for (double lambda : {0.0, 0.01, 1.0, kInfinity}) {
      SCOPED_TRACE(lambda);
      const OwnedDisk d = disk_of(mesh);
      UvMap uv = start_of(d.disk);
      ASSERT_TRUE(is_injective(d.disk, uv));
      const double before = energy_of(d.disk, uv, lambda);
      settle_apart(d.disk, {.rigidity = {lambda}, .constrained = {}, .stop = {}}, uv);
      EXPECT_TRUE(is_injective(d.disk, uv));
      EXPECT_LT(energy_of(d.disk, uv, lambda), 0.5 * before);
    }
}

TEST(SettleApart, MakesAFlatSurfaceFlat) {
  const OwnedDisk d = disk_of(shapes::grid(9, 7, 1.5, 1));
  UvMap uv = start_of(d.disk);
  settle_apart(d.disk, {}, uv);
  EXPECT_LT(energy_of(d.disk, uv, kInfinity), 1e-6);
}

TEST(SettleApart, EndsNearTheLeastEnergyWhereNothingPresses) {  // the barriers have faded
  const OwnedDisk d = disk_of(shapes::sphere_cap(24, 10, 2));
  UvMap settled = start_of(d.disk);
  settle_apart(d.disk, {}, settled);
  SerialExecutor serial;
  const UvMap least = Solver(d.disk, UnwrapOptions(), {}, serial).run(0, {}).uv;
  ASSERT_TRUE(is_injective(d.disk, least));
  EXPECT_LT(energy_of(d.disk, settled, kInfinity), 1.0005 * energy_of(d.disk, least, kInfinity));
}

TEST(SettleApart, StopsWhenAsked) {
  const OwnedDisk d = disk_of(shapes::random_disk(6, 1));
  UvMap uv = start_of(d.disk);
  std::stop_source source;
  source.request_stop();
  try {
    settle_apart(d.disk, {.rigidity = {}, .constrained = {}, .stop = source.get_token()}, uv);
    FAIL() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

TEST(InjectiveStep, IsHalvedUntilNothingOverlaps) {
  const OwnedDisk d =
      disk_of(shapes::mapped_grid(24, 1, shapes::Wrap::none, [](double u, double v) {
        return Vec3((1 + v) * std::cos(5.5 * u), (1 + v) * std::sin(5.5 * u), 0);
      }));
  UvMap uv;
  std::vector<Vec2> step;  // from an arc of 5.5 radians to one of 7
  for (const Vec3& p : d.chart->mesh.positions) {
    const double angle = std::atan2(p.y(), p.x()), turn = angle < 0 ? angle + shapes::kTurn : angle;
    const double wide = turn * 7 / 5.5;
    uv.emplace_back(p.x(), p.y());
    step.push_back(std::hypot(p.x(), p.y()) * Vec2(std::cos(wide), std::sin(wide)) - uv.back());
  }
  if (!measure::flipped_faces(d.disk.faces, uv).empty())
    for (std::size_t v = 0; v < uv.size(); ++v) uv[v].y() *= -1, step[v].y() *= -1;
  ASSERT_TRUE(is_injective(d.disk, uv));
  UvMap whole = uv;
  for (std::size_t v = 0; v < uv.size(); ++v) whole[v] += step[v];
  ASSERT_FALSE(is_injective(d.disk, whole));
  const UvMap before = uv;
  const auto towards = [&](const UvMap& map) {  // falls all the way
    double distance = 0;
    for (std::size_t v = 0; v < map.size(); ++v) distance += (map[v] - whole[v]).squaredNorm();
    return distance;
  };
  const std::optional<double> after = injective_step(d.disk, step, -2 * towards(uv), towards, uv);
  ASSERT_TRUE(after.has_value());
  EXPECT_EQ(*after, towards(uv));
  EXPECT_LT(*after, towards(before));
  EXPECT_TRUE(is_injective(d.disk, uv));
}

TEST(InjectiveStep, IsNoneUphill) {
  const OwnedDisk d = disk_of(shapes::grid(2, 2));
  UvMap uv = start_of(d.disk);
  const UvMap before = uv;
  const std::vector<Vec2> step(uv.size(), Vec2(1, 0));
  const auto first = [](const UvMap& map) { return map[0].x(); };
  EXPECT_FALSE(injective_step(d.disk, step, 1.0, first, uv).has_value());
  EXPECT_FALSE(injective_step(d.disk, step, -1.0, first, uv).has_value());  // a slope that lies
  EXPECT_EQ(uv, before);
}

}  // namespace
}  // namespace unwrapd::solve::repair
