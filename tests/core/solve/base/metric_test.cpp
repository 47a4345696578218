// Lengths, angles and curvature, and the holes that are closed before a metric is flattened.
#include "core/solve/base/metric.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "core/solve/maps/fill_holes.hpp"
#include "core/solve/maps/lay_out.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::solve {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

double total(const std::vector<double>& values) {
  double sum = 0;
  for (double value : values) sum += value;
  return sum;
}

Eigen::MatrixXd dense(const linear::SparseMatrix& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

TEST(CornerAngles, AreThoseOfTheTriangleInSpace) {
  const OwnedDisk d = disk_of(shapes::random_disk(8, 1));
  for (std::size_t t = 0; t < d.disk.faces.size(); ++t) {
    const std::array<double, 3> angle = corner_angles(d.disk.rest[t]);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = [&](std::size_t k) {
        return d.disk.positions[std::size_t(d.disk.faces[t][(i + k) % 3])];
      };
      const Vec3 a = at(1) - at(0), b = at(2) - at(0);
      EXPECT_NEAR(angle[i], std::acos(a.dot(b) / (a.norm() * b.norm())), 1e-9);
    }
  }
}

TEST(Curvature, AddsUpToTheEulerCharacteristic) {  // Gauss, Bonnet
  for (const auto& [mesh, euler] : {std::pair{shapes::random_disk(9, 2), 1},
                                    {shapes::cylinder(12, 4), 0},
                                    {shapes::sphere_cap(16, 5), 1}}) {
    const OwnedDisk d = disk_of(mesh);
    EXPECT_NEAR(total(curvature(d.disk, d.disk.rest)), 2 * std::numbers::pi * euler, 1e-9);
  }
}

TEST(Curvature, OfAConeIsAllAtItsApex) {
  const OwnedDisk d = disk_of(shapes::cone(200, 3, 1));
  const std::vector<double> k = curvature(d.disk, d.disk.rest);
  EXPECT_NEAR(k[0], 2 * std::numbers::pi * (1 - 1 / std::sqrt(2.0)), 1e-3);
  EXPECT_NEAR(inner_curvature(d.disk, k), k[0], 1e-12);
  for (std::size_t v = 1; v <= 200; ++v) EXPECT_NEAR(k[v], 0, 1e-3);
}

TEST(CotanLaplacian, IsTheChangeOfTheCurvatureUnderScaling) {  // central differences
  const OwnedDisk d = disk_of(shapes::random_disk(5, 3));
  const Eigen::MatrixXd laplacian = dense(cotan_laplacian(d.disk, d.disk.rest));
  constexpr double kStep = 1e-6;
  const auto scaled = [&](std::size_t v, double u) {
    std::vector<measure::RestTriangle> triangles;
    for (std::size_t t = 0; t < d.disk.faces.size(); ++t) {
      EdgeLengths l = edge_lengths(d.disk.rest[t]);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t end : {i, (i + 1) % 3})
          if (std::size_t(d.disk.faces[t][end]) == v) l[i] *= std::exp(u / 2);
      triangles.push_back(maps::triangle_of_lengths(l));
    }
    return curvature(d.disk, triangles);
  };
  for (std::size_t v = 0; v < d.disk.positions.size(); ++v) {
    const std::vector<double> high = scaled(v, kStep), low = scaled(v, -kStep);
    for (std::size_t w = 0; w < high.size(); ++w)
      EXPECT_NEAR((high[w] - low[w]) / (2 * kStep), laplacian(Index(w), Index(v)), 1e-6);
  }
}

TEST(Product, IsThatOfTheWholeMatrix) {
  const OwnedDisk d = disk_of(shapes::random_disk(6, 4));
  const linear::SparseMatrix lower = cotan_laplacian(d.disk, d.disk.rest);
  std::mt19937 rng(1);
  std::normal_distribution<double> normal;
  std::vector<double> x(d.disk.positions.size());
  for (double& value : x) value = normal(rng);
  const Eigen::VectorXd expected =
      dense(lower) * Eigen::Map<const Eigen::VectorXd>(x.data(), Index(x.size()));
  const std::vector<double> y = product(lower, x);
  for (std::size_t v = 0; v < y.size(); ++v) EXPECT_NEAR(y[v], expected[Index(v)], 1e-9);
}

TEST(InnerSystem, SolvesInsideAndLeavesTheBoundary) {
  const OwnedDisk d = disk_of(shapes::random_disk(7, 5));
  const linear::SparseMatrix lower = cotan_laplacian(d.disk, d.disk.rest);
  std::mt19937 rng(2);
  std::normal_distribution<double> normal;
  UvMap x;
  for (std::size_t v = 0; v < d.disk.positions.size(); ++v)
    x.emplace_back(normal(rng), normal(rng));
  const UvMap given = x;
  InnerSystem(d.disk, lower).solve(x);
  const std::vector<char> on_boundary = boundary_vertices(d.disk);
  for (int axis : {0, 1}) {
    std::vector<double> values;
    for (const Vec2& u : x) values.push_back(u[axis]);
    const std::vector<double> image = product(lower, values);
    for (std::size_t v = 0; v < x.size(); ++v)
      EXPECT_NEAR(on_boundary[v] ? x[v][axis] : image[v], given[v][axis], 1e-9);
  }
}

TEST(FlatScales, CancelTheCurvatureInsideToFirstOrder) {
  const OwnedDisk d = disk_of(shapes::random_disk(7, 6));
  const linear::SparseMatrix lower = cotan_laplacian(d.disk, d.disk.rest);
  const std::vector<double> k = curvature(d.disk, d.disk.rest);
  const std::vector<double> u = flat_scales(d.disk, InnerSystem(d.disk, lower), k);
  const std::vector<double> change = product(lower, u);
  const std::vector<char> on_boundary = boundary_vertices(d.disk);
  for (std::size_t v = 0; v < u.size(); ++v) {
    if (on_boundary[v])
      EXPECT_EQ(u[v], 0);
    else
      EXPECT_NEAR(k[v] + change[v], 0, 1e-9);
  }
}

TEST(FillHoles, LeavesAManifoldDiskOfOneBoundary) {
  const OwnedDisk d = disk_of(shapes::annulus(12, 3));
  const maps::FilledDisk filled = maps::fill_holes(d.disk);
  const Halfedges halfedges = build_halfedges(filled.faces, filled.disk.vertex_count());
  const auto open = std::count(halfedges.twin.begin(), halfedges.twin.end(), kNoTwin);
  EXPECT_EQ(std::size_t(open), d.disk.loops.front().size());
  EXPECT_EQ(filled.disk.rest.size(), filled.faces.size());
  EXPECT_EQ(filled.faces.size(), d.disk.faces.size() + d.disk.loops[1].size());
  EXPECT_EQ(filled.disk.vertex_count(), d.disk.vertex_count() + 1);
  EXPECT_NEAR(total(curvature(filled.disk, filled.disk.rest)), 2 * std::numbers::pi, 1e-9);
}

TEST(FillHoles, LeavesADiskOfOneBoundaryAsItIs) {
  const OwnedDisk d = disk_of(shapes::random_disk(5, 7));
  const maps::FilledDisk filled = maps::fill_holes(d.disk);
  EXPECT_EQ(filled.faces.size(), d.disk.faces.size());
  EXPECT_EQ(filled.disk.vertex_count(), d.disk.vertex_count());
}

TEST(FillHoles, OutlivesAMove) {
  const OwnedDisk d = disk_of(shapes::annulus(8, 2));
  maps::FilledDisk first = maps::fill_holes(d.disk);
  const maps::FilledDisk second = std::move(first);
  EXPECT_EQ(second.disk.faces.data(), second.faces.data());
  EXPECT_EQ(second.disk.loops.data(), second.loops.data());
}

}  // namespace
}  // namespace unwrapd::solve
