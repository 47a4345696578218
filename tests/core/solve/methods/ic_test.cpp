// The metric of circles, and what is ic's own; what it shares is in flattening_test.cpp.
#include "core/solve/methods/ic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/methods/bff.hpp"
#include "core/solve/methods/circle_packing.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::methods {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

/// The packing's length of side i of face t.
double packed_length(const Disk& disk, const CirclePacking& packing, std::size_t t, std::size_t i) {
  const double r = std::exp(packing.log_radius[std::size_t(disk.faces[t][i])]);
  const double s = std::exp(packing.log_radius[std::size_t(disk.faces[t][(i + 1) % 3])]);
  return std::sqrt(r * r + s * s + 2 * packing.crossing[t][i] * r * s);
}

/// Radii that vary by exp(spread), crossings of any angle up to a right one.
CirclePacking random_packing(const Disk& disk, std::mt19937& rng, double spread) {
  std::uniform_real_distribution<double> log(-spread, spread), cosine(0, 1);
  CirclePacking packing = circle_packing(disk);
  for (double& u : packing.log_radius) u = log(rng);
  for (auto& face : packing.crossing) face = {cosine(rng), cosine(rng), cosine(rng)};
  return packing;
}

TEST(PackedAngles, AreThoseOfTheLawOfCosines) {
  std::mt19937 rng(1);
  const OwnedDisk d = disk_of(shapes::random_disk(8, 1));
  const CirclePacking packing = random_packing(d.disk, rng, 1);
  const PackedAngles packed = packed_angles(d.disk, packing);
  for (std::size_t t = 0; t < d.disk.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = packed_length(d.disk, packing, t, i);
      const double b = packed_length(d.disk, packing, t, (i + 2) % 3);
      const double facing = packed_length(d.disk, packing, t, (i + 1) % 3);
      const double cosine = (a * a + b * b - facing * facing) / (2 * a * b);
      EXPECT_NEAR(packed.angle[t][i], std::acos(cosine), 1e-9);
    }
}

TEST(PackedAngles, MakeATriangleOfAnyRadii) {
  std::mt19937 rng(2);
  const OwnedDisk d = disk_of(shapes::random_disk(8, 2));
  for (double spread : {5.0, 50.0, 500.0}) {
    const PackedAngles packed = packed_angles(d.disk, random_packing(d.disk, rng, spread));
    for (const auto& angle : packed.angle)
      EXPECT_NEAR(angle[0] + angle[1] + angle[2], std::numbers::pi, 1e-12) << spread;
    for (double w : packed.weight) EXPECT_TRUE(w >= 0 && std::isfinite(w)) << spread << ' ' << w;
  }
}

TEST(PackedAngles, WeightsAreTheDerivativesOfTheCurvature) {
  std::mt19937 rng(3);
  const OwnedDisk d = disk_of(shapes::random_disk(5, 3));
  const CirclePacking packing = random_packing(d.disk, rng, 0.5);
  const PackedAngles packed = packed_angles(d.disk, packing);
  const linear::SparseMatrix lower =
      linear::lower_laplacian(d.disk.faces, d.disk.vertex_count(), packed.weight);
  constexpr double kStep = 1e-6;
  for (std::size_t v = 0; v < packing.log_radius.size(); ++v) {
    CirclePacking up = packing, down = packing;
    up.log_radius[v] += kStep, down.log_radius[v] -= kStep;
    const auto high = packed_angles(d.disk, up).curvature;
    const auto low = packed_angles(d.disk, down).curvature;
    for (std::size_t w = 0; w < high.size(); ++w)
      EXPECT_NEAR((high[w] - low[w]) / (2 * kStep),
                  lower.coeff(Index(std::max(v, w)), Index(std::min(v, w))), 1e-7);
  }
}

TEST(PackedAngles, CurvatureAddsUpToTheEulerCharacteristic) {  // Gauss, Bonnet
  std::mt19937 rng(4);
  for (const auto& [mesh, euler] :
       {std::pair{shapes::random_disk(6, 4), 1}, {shapes::annulus(12, 3), 0}}) {
    const OwnedDisk d = disk_of(mesh);
    double sum = 0;
    for (double k : packed_angles(d.disk, random_packing(d.disk, rng, 2)).curvature) sum += k;
    EXPECT_NEAR(sum, 2 * std::numbers::pi * euler, 1e-9);
  }
}

/// A bent strip of equilateral triangles.
TriMesh equilateral_strip(Index columns, Index rows) {
  TriMesh mesh = shapes::grid(columns, rows);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double i = double(Index(v) % (columns + 1)), j = double(Index(v) / (columns + 1));
    mesh.positions[v] = Vec3(i - j / 2, std::sqrt(0.75) * j, 0);
  }
  return mesh;
}

TEST(CirclePacking, HasTheLengthsOfTheMeshWhereNoTriangleIsObtuse) {
  for (const TriMesh& mesh : {equilateral_strip(8, 6), shapes::grid(6, 6)}) {
    const OwnedDisk d = disk_of(mesh);
    const CirclePacking packing = circle_packing(d.disk);
    for (std::size_t t = 0; t < d.disk.faces.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const double own = d.disk.rest[t].edge[i].norm();
        EXPECT_NEAR(packed_length(d.disk, packing, t, i), own, 1e-4 * own);
      }
  }
}

TEST(CirclePacking, GivesBothFacesAtAnEdgeOneLength) {
  const OwnedDisk d = disk_of(shapes::random_disk(10, 6));
  const CirclePacking packing = circle_packing(d.disk);
  for (std::size_t h = 0; h < d.chart->halfedges.twin.size(); ++h) {
    const Index twin = d.chart->halfedges.twin[h];
    if (twin == kNoTwin) continue;
    EXPECT_NEAR(packing.crossing[h / 3][h % 3],
                packing.crossing[std::size_t(twin / 3)][std::size_t(twin % 3)], 1e-12);
  }
}

TEST(Ic, IsIsometricWhereNoTriangleIsObtuseAndNothingIsCurved) {
  for (const TriMesh& mesh : {equilateral_strip(8, 6), shapes::grid(6, 6)}) {
    const OwnedDisk d = disk_of(mesh);
    const Distortion got =
        measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, ic(d.disk, {}).uv));
    EXPECT_NEAR(got.angle, 2, 1e-6);
    EXPECT_NEAR(got.area, 2, 1e-6);
  }
}

TEST(Ic, MakesEveryInnerVertexFlat) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const OwnedDisk d = disk_of(shapes::random_disk(Index(4 + 3 * seed), seed));
    const Solution s = ic(d.disk, {});
    EXPECT_EQ(s.stop_reason, StopReason::converged) << seed;
    EXPECT_LT(s.energy.back(), 1e-9) << seed;
    EXPECT_LT(s.iterations, 12) << seed;
  }
}

TEST(Ic, EndsWithinAnIterationOfACancel) {
  std::stop_source source;
  const OwnedDisk d = disk_of(shapes::random_disk(12, 3));
  int told = 0;
  const LoopWatch watch{.on_iteration = [&](const Solution&) { ++told, source.request_stop(); },
                        .stop = source.get_token()};
  EXPECT_THROW(ic(d.disk, {.on_stage = {}, .loop = watch}), Error);
  EXPECT_EQ(told, 1);
}

/// Every third face split at a point near its centre: inner vertices of three faces.
TriMesh with_split_faces(TriMesh mesh) {
  for (std::size_t t = 0, count = mesh.faces.size(); t < count; t += 3) {
    const auto [a, b, c] = mesh.faces[t];
    const Index centre = mesh.vertex_count();
    mesh.positions.push_back((mesh.positions[std::size_t(a)] + mesh.positions[std::size_t(b)] +
                              mesh.positions[std::size_t(c)]) /
                                 3 +
                             Vec3(0, 0, 0.01));
    mesh.faces[t] = {a, b, centre};
    mesh.faces.push_back({b, c, centre});
    mesh.faces.push_back({c, a, centre});
  }
  return mesh;
}

TEST(Ic, ConvergesAtVerticesOfThreeFaces) {  // circles that cross at right angles could not
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const OwnedDisk d = disk_of(with_split_faces(shapes::random_disk(10, seed)));
    const Solution s = ic(d.disk, {});
    EXPECT_EQ(s.stop_reason, StopReason::converged) << seed;
    EXPECT_LT(s.iterations, 12) << seed;
  }
}

TEST(CirclePacking, LetsTheLinksOfInnerVerticesCrossFlatEnoughToClose) {
  // The angles at a vertex whose circle shrinks to a point tend to the sum of (pi - crossing angle)
  // over its link: to be flat for some radius it must be more than 2 pi.
  for (const TriMesh& mesh : {with_split_faces(shapes::random_disk(9, 5)), shapes::cone(4, 2, 9),
                              shapes::cone(3, 2, 9), shapes::cone(4, 3, 0.1)}) {
    const OwnedDisk d = disk_of(mesh);
    const CirclePacking packing = circle_packing(d.disk);
    std::vector<double> most(d.disk.positions.size(), 0.0);
    for (std::size_t t = 0; t < d.disk.faces.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        most[std::size_t(d.disk.faces[t][i])] +=
            std::numbers::pi - std::acos(packing.crossing[t][(i + 1) % 3]);
    for (const BoundaryLoop& loop : d.disk.loops)
      for (Index h : loop) most[std::size_t(d.disk.faces[std::size_t(h / 3)][h % 3])] = 1e9;
    for (double sum : most) EXPECT_GT(sum, 2 * std::numbers::pi + 0.05);
  }
}

TEST(Ic, ConvergesAtVerticesOfFourFaces) {
  for (double skew : {0.0, 0.4, 0.8}) {  // a cross in a frame that is sheared
    TriMesh mesh = shapes::polar_disk(4, 3, shapes::kTurn, [&](double r, double phi) {
      return Vec3(r * (std::cos(phi) + skew * std::sin(phi)), r * std::sin(phi), r * r);
    });
    const OwnedDisk d = disk_of(std::move(mesh));
    EXPECT_EQ(ic(d.disk, {}).stop_reason, StopReason::converged) << skew;
  }
}

/// The northern half of a subdivided octahedron: its triangles are close to equilateral.
TriMesh hemisphere(int levels) {
  TriMesh mesh{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
               {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  for (int k = 0; k < levels; ++k) mesh = shapes::subdivided(mesh);
  for (Vec3& p : mesh.positions) p.normalize();
  return mesh;
}

TEST(Ic, IsNearlyConformalOnAcuteMeshes) {
  const OwnedDisk d = disk_of(hemisphere(4));
  const auto measured = [&](const Solution& s) {
    return measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, s.uv));
  };
  const Distortion circles = measured(ic(d.disk, {})), best = measured(bff(d.disk, {}));
  EXPECT_LT(circles.angle, best.angle + 0.02);
  EXPECT_NEAR(circles.area, best.area, 0.05 * best.area);
}

}  // namespace
}  // namespace unwrapd::solve::methods
