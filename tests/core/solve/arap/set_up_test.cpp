// What a job makes of a disk before its first solve, in parts that threads share.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/measure/distortion.hpp"
#include "core/solve/base/metric.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve::arap {
namespace {

using Triplet = Eigen::Triplet<double, Index>;

/// Of more vertices and faces than one part has, numbered at random.
TriMesh several_parts() { return shapes::shuffled(shapes::random_disk(100, 3), 4); }

std::vector<double> weights_of(std::span<const measure::RestTriangle> rest) {
  std::vector<double> weight;
  for (const measure::RestTriangle& t : rest)
    weight.insert(weight.end(), t.cot.begin(), t.cot.end());
  return weight;
}

linear::SparseMatrix laplacian_by_triplets(const TriMesh& mesh, const std::vector<double>& weight) {
  std::vector<Triplet> entries;
  for (std::size_t h = 0; h < weight.size(); ++h) {
    const Triangle& face = mesh.faces[h / 3];
    const auto [low, high] = std::minmax(face[h % 3], face[(h + 1) % 3]);
    entries.emplace_back(low, low, weight[h]);
    entries.emplace_back(high, high, weight[h]);
    entries.emplace_back(high, low, -weight[h]);
  }
  linear::SparseMatrix lower(mesh.vertex_count(), mesh.vertex_count());
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

bool are_equal(const linear::SparseMatrix& a, const linear::SparseMatrix& b) {
  const auto list = [](const auto* from, auto count) { return std::vector(from, from + count); };
  return list(a.outerIndexPtr(), a.cols() + 1) == list(b.outerIndexPtr(), b.cols() + 1) &&
         list(a.innerIndexPtr(), a.nonZeros()) == list(b.innerIndexPtr(), b.nonZeros()) &&
         list(a.valuePtr(), a.nonZeros()) == list(b.valuePtr(), b.nonZeros());
}

bool are_equal(const measure::RestTriangle& a, const measure::RestTriangle& b) {
  return a.edge == b.edge && a.cot == b.cot && a.area == b.area;
}

TEST(SetUp, AssemblesWhatTripletsDo) {
  const TriMesh mesh = several_parts();
  ASSERT_GT(part_count(mesh.positions.size()), 2U);
  const std::vector<double> weight = weights_of(measure::flatten(mesh));
  const linear::SparseMatrix lower =
      linear::lower_laplacian(mesh.faces, mesh.vertex_count(), weight);
  const linear::SparseMatrix expected = laplacian_by_triplets(mesh, weight);
  EXPECT_TRUE(lower.isCompressed());
  EXPECT_EQ(lower.nonZeros(), expected.nonZeros());
  EXPECT_LT((lower - expected).norm(), 1e-12 * expected.norm());
  for (Index j = 0; j < lower.cols(); ++j)
    EXPECT_TRUE(std::is_sorted(lower.innerIndexPtr() + lower.outerIndexPtr()[j],
                               lower.innerIndexPtr() + lower.outerIndexPtr()[j + 1]));
}

TEST(SetUp, LaysEveryFaceFlatAndAddsThemUp) {
  const TriMesh mesh = several_parts();
  const std::vector<measure::RestTriangle> rest = measure::flatten(mesh);
  ASSERT_EQ(rest.size(), mesh.faces.size());
  double area = 0;
  for (std::size_t t = 0; t < rest.size(); ++t) {
    EXPECT_TRUE(are_equal(rest[t], measure::flatten({mesh.positions, {mesh.faces[t]}})[0]));
    area += measure::face_area(mesh, mesh.faces[t]);
  }
  EXPECT_NEAR(measure::surface_area(mesh) / area, 1, 1e-13);
}

TEST(SetUp, FindsAllTheCurvatureThereIs) {  // Gauss, Bonnet: 2 pi a disk, whatever its shape
  const shapes::OwnedDisk d = shapes::disk_of(several_parts());
  const std::vector<double> k = curvature(d.disk, d.disk.rest);
  EXPECT_NEAR(std::accumulate(k.begin(), k.end(), 0.0), 2 * std::numbers::pi, 1e-8);
}

TEST(SetUp, HasTheSameBitsOnTwoThreads) {
  TwoThreads two;
  const shapes::OwnedDisk owned = shapes::disk_of(several_parts());
  const Disk& one = owned.disk;
  const Disk both = make_disk(owned.chart->mesh, one.loops, two);
  EXPECT_EQ(one.unit, both.unit);
  EXPECT_TRUE(std::ranges::equal(one.positions, both.positions));
  EXPECT_TRUE(std::ranges::equal(
      one.rest, both.rest, [](const measure::RestTriangle& a, const measure::RestTriangle& b) {
        return are_equal(a, b);
      }));
  EXPECT_EQ(curvature(one, one.rest), curvature(one, one.rest, two));
  const std::vector<double> weight = weights_of(one.rest);
  EXPECT_TRUE(are_equal(linear::lower_laplacian(one.faces, one.vertex_count(), weight),
                        linear::lower_laplacian(one.faces, one.vertex_count(), weight, two)));
  const UvMap uv = shapes::from_above(one);
  EXPECT_EQ(measure::uv_area(one.rest, one.faces, uv),
            measure::uv_area(one.rest, one.faces, uv, two));
}

TEST(SetUp, ADisksCopyHasItsLists) {
  const shapes::OwnedDisk owned = shapes::disk_of(shapes::random_disk(5, 3));
  const Disk copy = owned.disk;
  EXPECT_EQ(copy.positions.data(), owned.disk.positions.data());
  EXPECT_EQ(copy.rest.data(), owned.disk.rest.data());
  EXPECT_EQ(copy.corners.corner.data(), owned.disk.corners.corner.data());
}

}  // namespace
}  // namespace unwrapd::solve::arap
