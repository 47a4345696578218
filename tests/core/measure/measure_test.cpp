#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "tests/core/shapes.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::measure {
namespace {

UvMap flattened(const TriMesh& mesh) {
  UvMap uv;
  for (const Vec3& p : mesh.positions) uv.emplace_back(p.x(), p.y());
  return uv;
}

TEST(RestTriangle, KeepsLengthsAnglesAndArea) {
  const TriMesh mesh = shapes::random_disk(12, 1);
  const std::vector<RestTriangle> rest = flatten(mesh);
  for (std::size_t t = 0; t < rest.size(); ++t) {
    const Triangle& face = mesh.faces[t];
    const auto at = [&](std::size_t i) { return mesh.positions[std::size_t(face[i % 3])]; };
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(rest[t].edge[i].norm(), (at(i) - at(i + 1)).norm(), 1e-14);
      const Vec3 a = at(i) - at(i + 2), b = at(i + 1) - at(i + 2);
      EXPECT_NEAR(rest[t].cot[i], a.dot(b) / a.cross(b).norm(), 1e-10);
    }
    EXPECT_NEAR(rest[t].area, face_area(mesh, face), 1e-15);
    const Vec2 &x0 = rest[t].edge[0], &x1 = rest[t].edge[1];
    EXPECT_NEAR(x0.x() * x1.y() - x0.y() * x1.x(), 2 * rest[t].area, 1e-15);
  }
}

TEST(RestTriangle, RaisesTheHeightOfACapToAMillionthOfItsBase) {
  const TriMesh cap{{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}}, {{0, 1, 2}}};
  const std::vector<RestTriangle> rest = flatten(cap);
  EXPECT_NEAR(rest[0].area, 0.5 * kMinHeight, 1e-20);
}

TEST(RestTriangle, KeepsTheDigitsOfANeedle) {
  const TriMesh needle{{{0, 0, 0}, {1e-5, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_NEAR(flatten(needle)[0].area / 5e-6, 1, 1e-12);
}

TEST(Jacobian, HasTheSingularValuesOfAnSvd) {
  std::mt19937 rng(2);
  std::normal_distribution<double> any;
  for (int k = 0; k < 1000; ++k) {
    TriMesh mesh{{}, {{0, 1, 2}}};
    UvMap uv;
    for (int i = 0; i < 3; ++i) {
      mesh.positions.emplace_back(any(rng), any(rng), any(rng));
      uv.emplace_back(any(rng), any(rng));
    }
    const RestTriangle rest = flatten(mesh)[0];
    const UvEdges u = uv_edges(mesh.faces[0], uv);
    Eigen::Matrix2d from, to;
    from << rest.edge[0], rest.edge[1];
    to << u[0], u[1];
    const Eigen::Matrix2d dense = to * from.inverse();
    const Eigen::Vector2d sigma = Eigen::JacobiSVD<Eigen::Matrix2d>(dense).singularValues();
    const Jacobian j = jacobian(rest, u);
    const double scale = sigma[0];
    EXPECT_NEAR(j.sigma_max() / scale, 1, 1e-9);
    EXPECT_NEAR(j.sigma_min() / scale, std::copysign(sigma[1], dense.determinant()) / scale, 1e-9);
  }
}

TEST(Distortion, OfAnIsometryIsIdeal) {
  const TriMesh mesh = shapes::grid(7, 5);
  const Distortion d = distortion(distortion_sums(flatten(mesh), mesh.faces, flattened(mesh)));
  EXPECT_NEAR(d.angle, 2, 1e-12);
  EXPECT_NEAR(d.area, 2, 1e-12);
  EXPECT_NEAR(d.stretch, 1, 1e-12);
  EXPECT_EQ(d.flipped, 0);
}

TEST(Distortion, OfAnAnisotropicStretchFollowsSection6) {
  const TriMesh mesh = shapes::grid(4, 4);
  UvMap uv = flattened(mesh);
  for (Vec2& u : uv) u = Vec2(2 * u.x(), u.y()) * 17;  // the global scale must not matter
  const Distortion d = distortion(distortion_sums(flatten(mesh), mesh.faces, uv));
  EXPECT_NEAR(d.angle, 2 + 0.5, 1e-12);  // sigma 2 and 1
  EXPECT_NEAR(d.area, 2, 1e-12);         // the same area everywhere
  EXPECT_NEAR(d.stretch, std::sqrt((1.0 / 2 + 2.0 / 1) / 2), 1e-12);
}

TEST(Distortion, OfTwoHalvesOfDifferentSizeFollowsSection6) {
  const TriMesh mesh = shapes::grid(2, 1, 2, 1);
  UvMap uv = flattened(mesh);
  for (Vec2& u : uv)
    if (u.x() > 1.5) u.x() = 4;  // right half: 3 times the area of the left one
  const Distortion d = distortion(distortion_sums(flatten(mesh), mesh.faces, uv));
  const double left = 0.5, right = 1.5;  // det after scaling to the 3D area
  EXPECT_NEAR(d.area, (left + 1 / left + right + 1 / right) / 2, 1e-12);
}

TEST(Distortion, CountsFlipsAndNeverFallsBelowTwo) {
  const TriMesh mesh = shapes::grid(3, 3);
  UvMap uv = flattened(mesh);
  for (Vec2& u : uv) u.x() = -u.x();
  const Distortion d = distortion(distortion_sums(flatten(mesh), mesh.faces, uv));
  EXPECT_EQ(d.flipped, mesh.face_count());
  EXPECT_GE(d.angle, 2);
  EXPECT_GE(d.area, 2);
}

TEST(Distortion, OfAMapOntoAPointIsFarFromIdealAndFinite) {
  const TriMesh mesh = shapes::grid(3, 3);
  const UvMap point(mesh.positions.size(), Vec2(0.3, 0.7));
  const Distortion d = distortion(distortion_sums(flatten(mesh), mesh.faces, point));
  EXPECT_NEAR(d.angle, 1e6, 1);
  EXPECT_NEAR(d.area, 1e12, 1e6);
  EXPECT_NEAR(d.stretch, 1e6, 1);
  EXPECT_EQ(d.flipped, mesh.face_count());
}

/// Beside an isometry of the same area, a point is at the floor of the scale of both.
TEST(Distortion, OfAPointCountsByItsArea) {
  const TriMesh mesh = shapes::grid(3, 3);
  const UvMap point(mesh.positions.size(), Vec2(0, 0));
  DistortionSums sums = distortion_sums(flatten(mesh), mesh.faces, flattened(mesh));
  sums += distortion_sums(flatten(mesh), mesh.faces, point);
  const Distortion d = distortion(sums);
  EXPECT_NEAR(d.angle, (2 + 1e6) / 2, 1);
  EXPECT_NEAR(d.area, 1e12 / 2, 1e6);
  EXPECT_EQ(d.flipped, mesh.face_count());
}

/// Three points on a line, as far as floats tell: what shape they have is rounding's, and a map may
/// draw it out at will.
TEST(Distortion, IsNoMeanOverTrianglesThatRoundingShaped) {
  for (const double height : {1e-6, 1e-7, 1e-12, 0.0}) {
    TriMesh mesh = shapes::grid(1, 1);
    UvMap uv = flattened(mesh);
    mesh.positions.emplace_back(0.5, -height, 0);
    mesh.faces.push_back({0, 4, 1});
    uv.emplace_back(0.5, -1e3);
    const DistortionSums sums = distortion_sums(flatten(mesh), mesh.faces, uv);
    const Distortion d = distortion(sums);
    EXPECT_EQ(d.degenerate, 1) << height;
    EXPECT_EQ(d.flipped, 0) << height;
    EXPECT_NEAR(d.angle, 2, 1e-12) << height;
    EXPECT_NEAR(d.area, 2, 1e-12) << height;
    EXPECT_NEAR(d.stretch, 1, 1e-12) << height;
    EXPECT_NEAR(sums.uv_area, 501, 1e-9) << height;
  }
}

TEST(Distortion, OfSuchTrianglesAloneIsToldByTheirNumber) {
  TriMesh mesh = shapes::grid(3, 1);
  for (Vec3& p : mesh.positions) p.y() *= 1e-8;
  const UvMap uv = flattened(shapes::grid(3, 1));
  const Distortion d = distortion(distortion_sums(flatten(mesh), mesh.faces, uv));
  EXPECT_EQ(d.degenerate, mesh.face_count());
  EXPECT_EQ(d.angle, 2);
  EXPECT_EQ(d.area, 2);
  EXPECT_EQ(d.stretch, 1);
}

TEST(Distortion, OfAThinTriangleCounts) {
  TriMesh mesh = shapes::grid(1, 1);
  UvMap uv = flattened(mesh);
  mesh.positions.emplace_back(0.5, -1e-3, 0);
  mesh.faces.push_back({0, 4, 1});
  uv.emplace_back(0.5, -1);
  const Distortion d = distortion(distortion_sums(flatten(mesh), mesh.faces, uv));
  EXPECT_EQ(d.degenerate, 0);
  EXPECT_GT(d.angle, 2.4);
}

/// A map of more faces than are summed up at once, some of which it flips or flattens.
UvMap bent(const TriMesh& mesh, double wildness, std::mt19937& rng) {
  std::normal_distribution<double> any;
  UvMap uv = flattened(mesh);
  for (Vec2& u : uv) u += wildness * Vec2(any(rng), any(rng)) / 100;
  return uv;
}

DistortionSums sums_by_svd(const TriMesh& mesh, const UvMap& uv) {
  const std::vector<RestTriangle> rest = flatten(mesh);
  std::vector<Eigen::Vector2d> sigma;
  DistortionSums sums;
  double squares = 0;
  for (std::size_t t = 0; t < rest.size(); ++t) {
    const UvEdges u = uv_edges(mesh.faces[t], uv);
    Eigen::Matrix2d from, to;
    from << rest[t].edge[0], rest[t].edge[1];
    to << u[0], u[1];
    const Eigen::Matrix2d dense = to * from.inverse();
    sigma.emplace_back(Eigen::JacobiSVD<Eigen::Matrix2d>(dense).singularValues());
    sums.area += rest[t].area;
    sums.uv_area += rest[t].area * sigma.back().prod();
    sums.flipped += dense.determinant() <= 0 ? 1 : 0;
    squares += rest[t].area * sigma.back().squaredNorm();
  }
  const double floor = kMinSingularValue * std::sqrt(squares / (2 * sums.area));
  for (std::size_t t = 0; t < rest.size(); ++t) {
    const double a = rest[t].area, s1 = std::max(sigma[t][0], floor),
                 s2 = std::max(sigma[t][1], floor);
    sums.angle += a * (s1 / s2 + s2 / s1);
    sums.inverse += a / (s1 * s2);
    sums.stretch += a * (1 / (s1 * s1) + 1 / (s2 * s2)) / 2;
  }
  return sums;
}

TEST(Distortion, SumsUpWhatAnSvdOfEachFaceTells) {
  std::mt19937 rng(5);
  const TriMesh mesh = shapes::grid(80, 80);
  for (const double wildness : {0.0, 0.1, 30.0}) {
    UvMap uv = bent(mesh, wildness, rng);
    const auto at = [&](std::size_t i) -> Vec2& { return uv[std::size_t(mesh.faces[7000][i])]; };
    if (wildness < 1)  // one face alone, far below the floor, yet not flipped
      at(0) += (1 - 1e-9) * ((at(1) + at(2)) / 2 - at(0));
    const DistortionSums got = distortion_sums(flatten(mesh), mesh.faces, uv);
    const DistortionSums want = sums_by_svd(mesh, uv);
    EXPECT_NEAR(got.area / want.area, 1, 1e-12);
    EXPECT_NEAR(got.uv_area / want.uv_area, 1, 1e-12);
    EXPECT_NEAR(got.angle / want.angle, 1, 1e-6) << wildness;
    EXPECT_NEAR(got.inverse / want.inverse, 1, 1e-6) << wildness;
    EXPECT_NEAR(got.stretch / want.stretch, 1, 1e-6) << wildness;
    EXPECT_EQ(got.flipped, want.flipped) << wildness;
  }
}

TEST(Distortion, HasTheSameBitsOnTwoThreads) {
  std::mt19937 rng(6);
  const TriMesh mesh = shapes::grid(80, 80);
  const std::vector<RestTriangle> rest = flatten(mesh);
  for (const double wildness : {0.1, 30.0}) {
    const UvMap uv = bent(mesh, wildness, rng);
    TwoThreads two;
    const DistortionSums one = distortion_sums(rest, mesh.faces, uv);
    const DistortionSums both = distortion_sums(rest, mesh.faces, uv, two);
    EXPECT_EQ(one.angle, both.angle);
    EXPECT_EQ(one.inverse, both.inverse);
    EXPECT_EQ(one.stretch, both.stretch);
    EXPECT_EQ(one.uv_area, both.uv_area);
    EXPECT_EQ(one.flipped, both.flipped);
  }
}

TEST(Energy, IsZeroForAnIsometryAndKnownForAStretch) {  // Eqs. (A2), (A3)
  const TriMesh mesh = shapes::grid(4, 4);
  const std::vector<RestTriangle> rest = flatten(mesh);
  UvMap uv = flattened(mesh);
  EXPECT_NEAR(arap_energy(rest, mesh.faces, uv), 0, 1e-15);
  EXPECT_NEAR(asap_energy(rest, mesh.faces, uv), 0, 1e-15);
  for (Vec2& u : uv) u.x() *= 3;
  EXPECT_NEAR(arap_energy(rest, mesh.faces, uv), 4, 1e-12);
  EXPECT_NEAR(asap_energy(rest, mesh.faces, uv), 2, 1e-12);
}

}  // namespace
}  // namespace unwrapd::measure
