// Scale factors that are level on the boundary, found with the factor of the global step.
#include "core/solve/arap/even_boundary_scale_factors.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "core/solve/base/metric.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve::arap {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

constexpr int kFew = 9;  // solves

TriMesh bumpy(TriMesh mesh) {
  for (Vec3& p : mesh.positions) p.z() += 0.3 * std::sin(5 * p.x() + 1) * std::cos(4 * p.y());
  return mesh;
}

/// One boundary and several, the vertex that the global step holds (0) on it and inside, sides of
/// one length and of several.
std::vector<TriMesh> uneven_disks() {
  return {shapes::sphere_cap(40, 12, 2.2),    bumpy(shapes::grid(24, 16)),
          shapes::random_disk(20, 4),         bumpy(shapes::annulus(60, 8)),
          bumpy(shapes::annulus(24, 9, 0.1)), shapes::cone(24, 9, 1.5),
          bumpy(shapes::grid(30, 10, 3, 1))};
}

/// Of the values on the boundary, less their mean: root mean square.
double unevenness(const std::vector<double>& u, const std::vector<char>& on_boundary) {
  double sum = 0, count = 0, squares = 0;
  for (std::size_t v = 0; v < u.size(); ++v)
    if (on_boundary[v] != 0) sum += u[v], ++count;
  for (std::size_t v = 0; v < u.size(); ++v)
    if (on_boundary[v] != 0) squares += (u[v] - sum / count) * (u[v] - sum / count);
  return std::sqrt(squares / count);
}

/// The u of even fluxes through the boundary, by dense algebra; its mean is zero.
std::vector<double> under_even_fluxes(const linear::SparseMatrix& lower,
                                      const std::vector<double>& k,
                                      const std::vector<char>& on_boundary) {
  const auto n = static_cast<Eigen::Index>(k.size());
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
  for (std::size_t v = 0; v < k.size(); ++v)
    if (on_boundary[v] == 0) f[Eigen::Index(v)] = -k[v];
  double count = 0;
  for (const char on : on_boundary) count += on;
  const double sum = f.sum();
  for (std::size_t v = 0; v < k.size(); ++v)
    if (on_boundary[v] != 0) f[Eigen::Index(v)] = -sum / count;
  Eigen::MatrixXd all = Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
  all.array() += 1;  // holds the mean at zero
  const Eigen::VectorXd u = all.ldlt().solve(f);
  return {u.begin(), u.end()};
}

TEST(EvenBoundaryScaleFactors, AreExactInsideAndLevelOnTheBoundaryAfterAFewSolves) {
  for (const TriMesh& mesh : uneven_disks()) {
    const OwnedDisk d = disk_of(mesh);
    const std::vector<double> k = curvature(d.disk, d.disk.rest);
    const std::vector<char> on_boundary = boundary_vertices(d.disk);
    const auto u = even_boundary_scale_factors(d.disk, GlobalStep(d.disk, {}), k, kFew);
    ASSERT_TRUE(u.has_value()) << mesh.faces.size();
    const linear::SparseMatrix lower = cotan_laplacian(d.disk, d.disk.rest);
    const std::vector<double> change = product(lower, *u);
    for (std::size_t v = 0; v < k.size(); ++v)
      EXPECT_TRUE(on_boundary[v] != 0 || std::abs(change[v] + k[v]) < 1e-9);
    const double before = unevenness(under_even_fluxes(lower, k, on_boundary), on_boundary);
    EXPECT_LE(unevenness(*u, on_boundary), 1.001 * kLevel * before + 1e-10);
  }
}

TEST(EvenBoundaryScaleFactors, AreThereAtOnceWhereEvenFluxesAreRight) {
  const OwnedDisk d = disk_of(shapes::sphere_cap(40, 12, 1.5));  // as round as its boundary
  const std::vector<double> k = curvature(d.disk, d.disk.rest);
  const auto u = even_boundary_scale_factors(d.disk, GlobalStep(d.disk, {}), k, 2);
  ASSERT_TRUE(u.has_value());
  EXPECT_LT(unevenness(*u, boundary_vertices(d.disk)), 1e-9);
}

TEST(EvenBoundaryScaleFactors, TakeNoMoreSolvesOfALongerBoundary) {
  for (const Index side : {25, 50, 100}) {
    const OwnedDisk d = disk_of(bumpy(shapes::grid(side, side)));
    const std::vector<double> k = curvature(d.disk, d.disk.rest);
    EXPECT_TRUE(even_boundary_scale_factors(d.disk, GlobalStep(d.disk, {}), k, 5).has_value())
        << side;
  }
}

TEST(EvenBoundaryScaleFactors, AreGivenUpWhereTheyTakeTooManySolves) {
  const OwnedDisk d = disk_of(bumpy(shapes::grid(24, 16)));
  const std::vector<double> k = curvature(d.disk, d.disk.rest);
  EXPECT_FALSE(even_boundary_scale_factors(d.disk, GlobalStep(d.disk, {}), k, 2).has_value());
}

}  // namespace
}  // namespace unwrapd::solve::arap
