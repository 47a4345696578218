// Maps that one linear system gives: convex and conformal ones.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/solve/maps/conformal.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::maps {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

Index flips(const Disk& disk, const UvMap& uv) {
  return measure::distortion_sums(disk.rest, disk.faces, uv).flipped;
}

std::vector<char> on_longest_loop(const Disk& disk) {
  std::vector<char> on(disk.positions.size(), 0);
  for (Index h : disk.loops.front()) on[std::size_t(disk.faces[std::size_t(h / 3)][h % 3])] = 1;
  return on;
}

TEST(ConvexMap, HasNoFlipsOnRandomDisks) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const OwnedDisk d = disk_of(shapes::random_disk(Index(3 + seed), seed));
    EXPECT_EQ(flips(d.disk, tutte_map(d.disk)), 0) << seed;
    EXPECT_EQ(flips(d.disk, mean_value_map(d.disk)), 0) << seed;
  }
}

TEST(ConvexMap, TutteVerticesAreMeansOfTheirNeighbours) {
  const OwnedDisk d = disk_of(shapes::annulus(16, 4));
  const UvMap uv = tutte_map(d.disk);
  const std::vector<char> hard = on_longest_loop(d.disk);
  for (std::size_t v = 0; v < uv.size(); ++v) {
    if (hard[v]) continue;
    Vec2 sum = Vec2::Zero();
    double count = 0;
    for (const Triangle& face : d.disk.faces)
      for (std::size_t i = 0; i < 3; ++i)
        if (std::size_t(face[i]) == v)
          for (std::size_t k : {1U, 2U}) sum += uv[std::size_t(face[(i + k) % 3])], ++count;
    EXPECT_LT((uv[v] - sum / count).norm(), 1e-12);
  }
}

/// Angle at a between b and c by the scalar product: a second way to the weights.
double angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::acos((b - a).normalized().dot((c - a).normalized()));
}

TEST(ConvexMap, MeanValueVerticesBalanceFloatersWeights) {  // Floater 2003, Eq. (2.1)
  const OwnedDisk d = disk_of(shapes::random_disk(8, 5));
  const UvMap uv = mean_value_map(d.disk);
  const std::vector<char> hard = on_longest_loop(d.disk);
  for (std::size_t v = 0; v < uv.size(); ++v) {
    if (hard[v]) continue;
    Vec2 sum = Vec2::Zero();
    double total = 0;
    for (const Triangle& face : d.disk.faces)
      for (std::size_t i = 0; i < 3; ++i) {
        if (std::size_t(face[i]) != v) continue;
        const auto b = std::size_t(face[(i + 1) % 3]), c = std::size_t(face[(i + 2) % 3]);
        const auto& p = d.disk.positions;
        const double t = std::tan(angle(p[v], p[b], p[c]) / 2);
        for (std::size_t j : {b, c}) {
          const double w = t / (p[j] - p[v]).norm();
          sum += w * (uv[j] - uv[v]);
          total += w;
        }
      }
    EXPECT_LT(sum.norm() / total, 1e-9);
  }
}

TEST(ConvexMap, ReproducesAFlatDisk) {  // mean values are exact on linear functions
  const OwnedDisk d = disk_of(shapes::polar_disk(40, 6, shapes::kTurn, [](double r, double phi) {
    return Vec3(r * std::cos(phi), r * std::sin(phi), 0);
  }));
  const UvMap uv = mean_value_map(d.disk);
  const Distortion q = measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, uv));
  EXPECT_NEAR(q.angle, 2, 1e-9);
  EXPECT_NEAR(q.area, 2, 1e-9);
}

TEST(ConvexMap, AcceptsADiskWithoutInnerVertices) {
  const OwnedDisk d = disk_of(shapes::grid(6, 1));
  EXPECT_EQ(flips(d.disk, tutte_map(d.disk)), 0);
  EXPECT_EQ(flips(d.disk, mean_value_map(d.disk)), 0);
}

/// The conformal energy as a dense quadratic form of (x0, y0, x1, y1, ...), from the Jacobians.
Eigen::MatrixXd dense_conformal(const Disk& disk) {
  const Index n = disk.vertex_count();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * Index(disk.faces.size()), 2 * n);
  for (std::size_t t = 0; t < disk.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      for (int k : {0, 1}) {
        UvMap unit(disk.positions.size(), Vec2::Zero());
        unit[std::size_t(disk.faces[t][i])][k] = 1;
        const measure::Jacobian j =
            measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], unit));
        const double w = std::sqrt(2 * disk.rest[t].area);
        rows(2 * Index(t), 2 * disk.faces[t][i] + k) += w * j.f;
        rows(2 * Index(t) + 1, 2 * disk.faces[t][i] + k) += w * j.g;
      }
  return rows.transpose() * rows;
}

Eigen::VectorXd stacked(const UvMap& uv) {
  Eigen::VectorXd x(2 * Index(uv.size()));
  for (std::size_t v = 0; v < uv.size(); ++v) x.segment<2>(2 * Index(v)) = uv[v];
  return x;
}

TEST(ConformalMap, IsStationaryButForItsTwoPins) {  // Sec. 4.2, against a dense second formula
  for (const TriMesh& mesh : {shapes::random_disk(7, 3), shapes::annulus(14, 3)}) {
    const OwnedDisk d = disk_of(mesh);
    const UvMap uv = conformal_map(d.disk, Pins::diameter);
    const Eigen::MatrixXd form = dense_conformal(d.disk);
    const Eigen::VectorXd x = stacked(uv);
    EXPECT_NEAR(x.dot(form * x), measure::asap_energy(d.disk.rest, d.disk.faces, uv), 1e-12);
    const Eigen::VectorXd force = form * x;
    int loaded = 0;
    for (Index v = 0; v < d.disk.vertex_count(); ++v)
      if (force.segment<2>(2 * v).norm() > 1e-9) ++loaded;
    EXPECT_LE(loaded, 2);
  }
}

TEST(ConformalMap, SpectralHasTheLeastEnergyPerBoundaryNorm) {  // Mullen et al. 2008
  const OwnedDisk d = disk_of(shapes::random_disk(6, 4));
  const UvMap uv = conformal_map(d.disk, Pins::spectral);
  const Index n = d.disk.vertex_count();
  Eigen::MatrixXd norm = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  const std::vector<char> on = on_longest_loop(d.disk);
  const double count = double(std::count(on.begin(), on.end(), 1));
  for (Index v = 0; v < n; ++v)
    for (Index w = 0; w < n; ++w)
      for (int k : {0, 1})
        if (on[std::size_t(v)] && on[std::size_t(w)])
          norm(2 * v + k, 2 * w + k) = (v == w ? 1.0 : 0.0) - 1 / count;  // mean taken out
  const Eigen::MatrixXd form = dense_conformal(d.disk);
  const auto quotient = [&](const Eigen::VectorXd& x) { return x.dot(form * x) / x.dot(norm * x); };
  // The largest eigenvalue of (form + norm)^+ norm belongs to the smallest quotient.
  const Eigen::MatrixXd both = form + norm + 1e-12 * Eigen::MatrixXd::Identity(2 * n, 2 * n);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(norm, both);
  const double least = 1 / eigen.eigenvalues()[2 * n - 1] - 1;
  EXPECT_NEAR(quotient(stacked(uv)) / least, 1, 1e-4);
  EXPECT_LE(quotient(stacked(uv)),
            quotient(stacked(conformal_map(d.disk, Pins::diameter))) * (1 + 1e-9));
}

TEST(ConformalMap, FlattensDevelopableShapesExactly) {
  for (const TriMesh& mesh :
       {shapes::half_cylinder(20, 10), shapes::cone_sector(20, 8), shapes::grid(9, 4)})
    for (Pins pins : {Pins::diameter, Pins::spectral}) {
      const OwnedDisk d = disk_of(mesh);
      const UvMap uv = conformal_map(d.disk, pins);
      EXPECT_LT(measure::arap_energy(d.disk.rest, d.disk.faces, uv), 1e-10);
      EXPECT_EQ(flips(d.disk, uv), 0);
    }
}

TEST(Diameter, IsTheFarthestPairOfBruteForce) {
  std::mt19937 rng(8);
  std::normal_distribution<double> any;
  for (int k = 0; k < 50; ++k) {
    std::vector<Vec3> cloud;
    for (int i = 0; i < 60; ++i) cloud.emplace_back(any(rng), any(rng), any(rng));
    if (k % 2 == 1)
      for (Vec3& p : cloud) p.normalize();  // nothing can be pruned on a sphere
    double most = 0;
    for (const Vec3& a : cloud)
      for (const Vec3& b : cloud) most = std::max(most, (a - b).norm());
    const auto [a, b] = diameter(cloud);
    EXPECT_LT(a, b);
    EXPECT_EQ((cloud[std::size_t(a)] - cloud[std::size_t(b)]).norm(), most);
  }
}

}  // namespace
}  // namespace unwrapd::solve::maps
