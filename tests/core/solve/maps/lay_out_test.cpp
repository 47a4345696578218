// From the shapes of triangles to a map.
#include "core/solve/maps/lay_out.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/similarity.hpp"

namespace unwrapd::solve::maps {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

/// The angle between two sides of given lengths, by the law of cosines.
double angle_between(double a, double b, double facing) {
  return std::acos((a * a + b * b - facing * facing) / (2 * a * b));
}

double heron(const std::array<double, 3>& l) {
  const double s = (l[0] + l[1] + l[2]) / 2;
  return std::sqrt(s * (s - l[0]) * (s - l[1]) * (s - l[2]));
}

void expect_consistent(const measure::RestTriangle& t) {
  EXPECT_LT((t.edge[0] + t.edge[1] + t.edge[2]).norm(), 1e-12 * t.edge[0].norm() + 1e-12);
  const double cross = t.edge[0].x() * t.edge[1].y() - t.edge[0].y() * t.edge[1].x();
  EXPECT_NEAR(cross / 2, t.area, 1e-9 * t.area);  // counter-clockwise
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 p = t.edge[(i + 2) % 3], q = -t.edge[(i + 1) % 3];
    EXPECT_NEAR(t.cot[i], p.dot(q) / cross, 1e-9 * (1 + std::abs(t.cot[i])));
  }
}

TEST(TriangleOfLengths, HasTheLengthsAndTheAnglesOfTheLawOfCosines) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> side(0.2, 3);
  for (int k = 0; k < 2000; ++k) {
    const std::array<double, 3> l{side(rng), side(rng), side(rng)};
    if (2 * std::max({l[0], l[1], l[2]}) > 0.999 * (l[0] + l[1] + l[2])) continue;
    const measure::RestTriangle t = triangle_of_lengths(l);
    expect_consistent(t);
    EXPECT_NEAR(t.area, heron(l), 1e-9);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(t.edge[i].norm(), l[i], 1e-12);
      const double facing = angle_between(l[(i + 1) % 3], l[(i + 2) % 3], l[i]);
      EXPECT_NEAR(std::atan2(1.0, t.cot[i]), facing, 1e-9);
    }
  }
}

TEST(TriangleOfLengths, IsTheSameShapeInAnyUnit) {
  const measure::RestTriangle t = triangle_of_lengths({3, 4, 5});
  for (double unit : {1e-140, 1e-9, 1e9, 1e140}) {
    const measure::RestTriangle s = triangle_of_lengths({3 * unit, 4 * unit, 5 * unit});
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(s.cot[i], t.cot[i], 1e-12) << unit;
  }
}

TEST(TriangleOfLengths, DrawsABrokenTriangleFlatOnItsLongestSide) {
  for (const std::array<double, 3>& l : {std::array<double, 3>{1, 1, 3},
                                         {3, 1, 1},
                                         {1, 3, 1},
                                         {0, 1, 1},
                                         {1, 0, 1},
                                         {1, 1, 0},
                                         {0, 0, 2},
                                         {1, 1, 2}}) {
    const measure::RestTriangle t = triangle_of_lengths(l);
    expect_consistent(t);
    const std::size_t k = std::size_t(std::max_element(l.begin(), l.end()) - l.begin());
    EXPECT_NEAR(t.edge[k].norm(), l[k], 1e-12);
    EXPECT_NEAR(2 * t.area / l[k], measure::kMinHeight * l[k], 1e-12);
    for (const Vec2& e : t.edge) EXPECT_LE(e.norm(), l[k] * (1 + 1e-9));
  }
}

TEST(TriangleOfAngles, HasTheSidesOfTheLawOfSinesAndAreaOne) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> part(0.02, 1), excess(0.5, 2);
  for (int k = 0; k < 2000; ++k) {
    std::array<double, 3> angle{part(rng), part(rng), part(rng)};
    const double unit = std::numbers::pi / (angle[0] + angle[1] + angle[2]), factor = excess(rng);
    const measure::RestTriangle t = triangle_of_angles(
        {factor * unit * angle[0], factor * unit * angle[1], factor * unit * angle[2]});
    expect_consistent(t);
    EXPECT_NEAR(t.area, 1, 1e-12);
    const double diameter = t.edge[0].norm() / std::sin(unit * angle[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      const double facing = unit * angle[(i + 2) % 3];
      EXPECT_NEAR(t.edge[i].norm(), diameter * std::sin(facing), 1e-9 * diameter);
      EXPECT_NEAR(std::atan2(1.0, t.cot[i]), facing, 1e-9);
    }
  }
}

TEST(TriangleOfAngles, RaisesAVanishingHeight) {
  for (const std::array<double, 3>& angle : {std::array<double, 3>{std::numbers::pi, 1e-12, 1e-12},
                                             {1e-12, std::numbers::pi, 1e-12},
                                             {1e-300, 1, std::numbers::pi - 1}}) {
    const measure::RestTriangle t = triangle_of_angles(angle);
    expect_consistent(t);
    double longest = 0;
    for (const Vec2& e : t.edge) longest = std::max(longest, e.norm());
    EXPECT_GE(2 * t.area / longest, 0.999 * measure::kMinHeight * longest);
  }
}

/// A random disk pressed flat, its triangles all of positive area.
TriMesh flat_disk(unsigned seed) {
  TriMesh mesh = shapes::random_disk(12, seed);
  for (Vec3& p : mesh.positions) p.z() = 0;
  return mesh;
}

double misfit(const Disk& disk, const UvMap& uv) {
  UvMap plane;
  for (const Vec3& p : disk.positions) plane.emplace_back(p.x(), p.y());
  return gap_up_to_similarity(uv, plane);
}

TEST(LayOut, PutsFlatTrianglesBackTogetherWhateverTheirSizes) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> exponent(-5, 5);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const OwnedDisk d = disk_of(flat_disk(seed));
    std::vector<measure::RestTriangle> flat;
    for (const measure::RestTriangle& rest : d.disk.rest) {
      const double unit = std::exp(exponent(rng));
      flat.push_back(triangle_of_lengths(
          {unit * rest.edge[0].norm(), unit * rest.edge[1].norm(), unit * rest.edge[2].norm()}));
    }
    const UvMap uv = lay_out(d.disk, flat);
    EXPECT_LT(misfit(d.disk, uv), 1e-9) << seed;
    EXPECT_NEAR(measure::uv_area(d.disk.rest, d.disk.faces, uv), 1, 1e-9);
  }
}

TEST(LayOut, NeedsTheAnglesOnly) {
  const OwnedDisk d = disk_of(flat_disk(20));
  std::vector<measure::RestTriangle> flat;
  for (const measure::RestTriangle& rest : d.disk.rest)
    flat.push_back(triangle_of_angles({std::atan2(1.0, rest.cot[1]), std::atan2(1.0, rest.cot[2]),
                                       std::atan2(1.0, rest.cot[0])}));
  EXPECT_LT(misfit(d.disk, lay_out(d.disk, flat)), 1e-9);
}

TEST(LayOut, OfTheDiskItselfIsTheConformalMap) {
  const OwnedDisk d = disk_of(shapes::sphere_cap(20, 8));
  const UvMap uv = lay_out(d.disk, {d.disk.rest.begin(), d.disk.rest.end()});
  EXPECT_LT(measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, uv)).angle,
            2.01);
}

TEST(ScaleToArea, RefusesAMapWithoutArea) {
  const OwnedDisk d = disk_of(shapes::grid(2, 2));
  UvMap uv(d.disk.positions.size(), Vec2(1, 2));
  EXPECT_THROW(scale_to_area(d.disk, uv), Error);
}

}  // namespace
}  // namespace unwrapd::solve::maps
