// What is left of each method's own map where it must not lie on itself.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/methods/symmetric_dirichlet.hpp"
#include "core/solve/repair/bijective.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::repair {
namespace {

using shapes::disk_of;
using shapes::kTurn;
using shapes::OwnedDisk;

UvMap map_of(const Disk& disk, Method method = Method::arap) {
  SerialExecutor serial;
  const UnwrapOptions options{.method = method};
  return Solver(disk, options, {}, serial).run(0, {}).uv;
}

std::size_t pairs_in(const Disk& disk, const UvMap& uv) {
  return measure::overlapping_pairs(disk.faces, uv, 1 << 20).size();
}

/// ARAP's energy at its best scale, and the worst stretch where UV area = 3D area.
struct Quality {
  double energy, stretch;
};

Quality quality_of(const Disk& disk, const UvMap& uv) {
  double area = 0, uv_area = 0, sum = 0, square = 0, high = 0, low = 1e9;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    const measure::Jacobian j =
        measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv));
    area += disk.rest[t].area;
    uv_area += disk.rest[t].area * j.determinant();
    sum += disk.rest[t].area * (j.sigma_max() + j.sigma_min());
    square += disk.rest[t].area * j.squared_norm();
    high = std::max(high, j.sigma_max());
    low = std::min(low, j.sigma_min());
  }
  const double scale = std::sqrt(area / uv_area);
  return {2 - sum * sum / (square * area), std::max(high * scale, 1 / (low * scale))};
}

/// More than a turn of a ramp with hills: no map of it is isometric.
TriMesh hilly_ramp() {
  return shapes::mapped_grid(100, 6, shapes::Wrap::none, [](double u, double v) {
    const double angle = kTurn * 1.5 * u, radius = 1 + 0.5 * (1 - v);
    return Vec3(radius * std::cos(angle), radius * std::sin(angle),
                0.4 * u + 0.1 * std::sin(40 * u) * std::sin(6 * v));
  });
}

/// MIPS of the map from one map to another, both without flips: 0 where their angles are the same.
double turned_angles(const Disk& disk, const UvMap& from, const UvMap& to) {
  double sum = 0, area = 0;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    const measure::UvEdges u = measure::uv_edges(disk.faces[t], from);
    const measure::RestTriangle rest{u, {}, (u[0].x() * u[1].y() - u[0].y() * u[1].x()) / 2};
    const measure::Jacobian j = measure::jacobian(rest, measure::uv_edges(disk.faces[t], to));
    sum += disk.rest[t].area * (j.squared_norm() / j.determinant() - 2);
    area += disk.rest[t].area;
  }
  return sum / area;
}

TEST(BijectiveEnergy, KeepsTheAnglesOfEachMethod) {
  const OwnedDisk d = disk_of(hilly_ramp());
  const std::array methods{Method::asap, Method::abf, Method::bff, Method::cp, Method::ic};
  std::vector<UvMap> own, apart;
  int overlapping = 0;
  for (const Method method : methods) {
    own.push_back(map_of(d.disk, method));
    ASSERT_TRUE(measure::flipped_faces(d.disk.faces, own.back()).empty());
    overlapping += pairs_in(d.disk, own.back()) > 0 ? 1 : 0;
    apart.push_back(own.back());
    ASSERT_TRUE(map_injectively(
        d.disk, {.rigidity = {.lambda = 0}, .constrained = {}, .stop = {}, .own = OwnEnergy::mips},
        apart.back()));
    EXPECT_EQ(pairs_in(d.disk, apart.back()), 0U);
  }
  EXPECT_GE(overlapping, 3);
  int far = 0;
  for (std::size_t a = 0; a < own.size(); ++a)
    for (std::size_t b = 0; b < own.size(); ++b) {
      if (b == a) continue;
      SCOPED_TRACE(std::to_string(a) + " " + std::to_string(b));
      EXPECT_GT(turned_angles(d.disk, apart[a], apart[b]), 1e-7);
      const double moved = turned_angles(d.disk, own[a], apart[a]);
      if (turned_angles(d.disk, own[a], own[b]) < 4 * moved) continue;  // all but the same map
      ++far;
      EXPECT_LT(moved, 0.5 * turned_angles(d.disk, own[a], apart[b]));
    }
  EXPECT_GE(far, 8);
}

TEST(BijectiveEnergy, LowersTheEnergyOfItsMethod) {
  const OwnedDisk d = disk_of(hilly_ramp());
  SerialExecutor serial;
  UvMap arap = map_of(d.disk), slim = arap;
  ASSERT_TRUE(map_injectively(d.disk, {}, arap));
  ASSERT_TRUE(map_injectively(
      d.disk,
      {.rigidity = {}, .constrained = {}, .stop = {}, .own = OwnEnergy::symmetric_dirichlet},
      slim));
  EXPECT_LT(methods::symmetric_dirichlet_energy(d.disk, slim, serial),
            methods::symmetric_dirichlet_energy(d.disk, arap, serial));
  EXPECT_LT(quality_of(d.disk, arap).energy, quality_of(d.disk, slim).energy);
}

TEST(BijectiveEnergy, CostsSlimNextToNothing) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  const OwnedDisk d = disk_of(read_obj(test_data() / "paper/Cow_dABF.obj"));
  SerialExecutor serial;
  UvMap uv = map_of(d.disk, Method::slim);
  const double free = methods::symmetric_dirichlet_energy(d.disk, uv, serial);
  ASSERT_TRUE(map_injectively(
      d.disk,
      {.rigidity = {}, .constrained = {}, .stop = {}, .own = OwnEnergy::symmetric_dirichlet}, uv));
  EXPECT_LT(methods::symmetric_dirichlet_energy(d.disk, uv, serial), 1.005 * free);
}

/// Flat pieces around points of curvature: spikes, where ARAP alone lets triangles collapse.
TriMesh spiked() {
  return shapes::mapped_grid(24, 24, shapes::Wrap::none, [](double u, double v) {
    const double x = 4 * u - 2, y = 4 * v - 2;
    const double r = std::hypot(x, y);
    return Vec3(x, y, 1.6 * std::max(0.0, 1 - 2 * r));
  });
}

TEST(BijectiveEnergy, ComesToTheFreeMinimumWhereThatIsInjective) {
  for (const auto& [name, mesh] :
       {std::pair("cap", shapes::sphere_cap(24, 12, 2)),
        std::pair("wave", shapes::mapped_grid(30, 30, shapes::Wrap::none, [](double u, double v) {
                    return Vec3(u, v, 0.1 * std::sin(9 * u) * std::sin(7 * v));
                  }))}) {
    SCOPED_TRACE(name);
    const OwnedDisk d = disk_of(mesh);
    const UvMap free = map_of(d.disk);
    ASSERT_EQ(pairs_in(d.disk, free), 0U);
    UvMap uv = free;
    ASSERT_TRUE(map_injectively(d.disk, {}, uv));
    EXPECT_LT(quality_of(d.disk, uv).energy, 1.005 * quality_of(d.disk, free).energy);
  }
}

TEST(BijectiveEnergy, StretchesNoTriangleMuch) {
  const OwnedDisk d = disk_of(spiked());
  UvMap uv = map_of(d.disk);
  ASSERT_TRUE(map_injectively(d.disk, {}, uv));
  EXPECT_LT(quality_of(d.disk, uv).stretch, 5);  // the spike is steep
}

TEST(BijectiveEnergy, HasLittleEnergyAndStretchOnRealMeshes) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  for (const auto& [name, energy] :
       {std::pair("paper/Cow_dABF.obj", 0.0225), std::pair("disk/fish22k_pd_cut.obj", 0.03763)}) {
    SCOPED_TRACE(name);
    const OwnedDisk d = disk_of(read_obj(test_data() / name));
    UvMap uv(d.disk.positions.size(), Vec2::Zero());
    ASSERT_TRUE(map_injectively(d.disk, {}, uv));
    EXPECT_LE(quality_of(d.disk, uv).energy, energy);
    EXPECT_LE(quality_of(d.disk, uv).stretch, 4.5);
  }
}

}  // namespace
}  // namespace unwrapd::solve::repair
