// Linear ABF against a dense minimum-norm solution, and against ABF++, which it approximates.
#include "core/solve/methods/linabf.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "core/measure/distortion.hpp"
#include "core/solve/methods/abf.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/odd_disks.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve::methods {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

std::vector<FaceAngles> solved(const Disk& disk) {
  SerialExecutor serial;
  return linear_angles(disk, serial);
}

std::vector<char> on_boundary(const Disk& disk) {
  std::vector<char> on(disk.positions.size(), 0);
  for (const BoundaryLoop& loop : disk.loops)
    for (Index h : loop) on[std::size_t(disk.faces[std::size_t(h / 3)][h % 3])] = 1;
  return on;
}

/// Zayer, Levy, Seidel 2007, Sec. 3: A e = b, and the least sum of (e / gamma)^2 under it is
/// e = G (A G)^+ b with G the diagonal of the estimates. One boundary.
Eigen::VectorXd dense_errors(const Disk& disk, const std::vector<FaceAngles>& gamma) {
  const Index faces = Index(disk.faces.size());
  const std::vector<char> outer = on_boundary(disk);
  Index row = faces;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(faces + 2 * disk.vertex_count(), 3 * faces);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(a.rows()), scale(3 * faces);
  for (Index t = 0; t < faces; ++t)
    for (Index i = 0; i < 3; ++i) {
      scale[3 * t + i] = gamma[std::size_t(t)][std::size_t(i)];
      a(t, 3 * t + i) = 1;
      b[t] += std::numbers::pi / 3 - scale[3 * t + i];
    }
  for (std::size_t v = 0; v < outer.size(); ++v) {
    if (outer[v] != 0) continue;
    b[row] = 2 * std::numbers::pi;
    for (Index t = 0; t < faces; ++t)
      for (Index i = 0; i < 3; ++i) {
        if (std::size_t(disk.faces[std::size_t(t)][std::size_t(i)]) != v) continue;
        const Index after = 3 * t + (i + 1) % 3, before = 3 * t + (i + 2) % 3;
        a(row, 3 * t + i) = 1;
        b[row] -= scale[3 * t + i];
        a(row + 1, after) += 1 / std::tan(scale[after]);
        a(row + 1, before) -= 1 / std::tan(scale[before]);
        b[row + 1] += std::log(std::sin(scale[before])) - std::log(std::sin(scale[after]));
      }
    row += 2;
  }
  const Eigen::MatrixXd weighted = a.topRows(row) * scale.asDiagonal();
  return scale.asDiagonal() * weighted.completeOrthogonalDecomposition().solve(b.head(row));
}

TEST(LinearAngles, AreTheDenseMinimumNormSolution) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const OwnedDisk d = disk_of(shapes::random_disk(Index(2 + seed), seed));
    const std::vector<FaceAngles> gamma = target_angles(d.disk), got = solved(d.disk);
    const Eigen::VectorXd expected = dense_errors(d.disk, gamma);
    EXPECT_GT(expected.norm(), 1e-2);
    for (std::size_t t = 0; t < got.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(got[t][i] - gamma[t][i], expected[3 * Index(t) + Index(i)], 1e-9);
  }
}

TEST(LinearAngles, AddUpToAHalfTurnInEveryTriangle) {
  std::vector<shapes::NamedMesh> meshes = odd::hard_disks();
  meshes.push_back({"a pinhole", shapes::sphere_cap(40, 30, 3.1)});  // the linear model fails there
  meshes.push_back({"a pinhole in a cube", shapes::cube(2)});
  meshes.back().mesh.faces.pop_back();
  for (const auto& [name, mesh] : meshes) {
    const OwnedDisk d = disk_of(mesh);
    for (const FaceAngles& a : solved(d.disk)) {
      EXPECT_NEAR(a[0] + a[1] + a[2], std::numbers::pi, 1e-9) << name;
      for (double x : a) EXPECT_TRUE(x > 0 && x < std::numbers::pi) << name << ": " << x;
    }
  }
}

TEST(LinearAngles, ErrWithTheSquareOfTheCurvature) {  // a linearisation: half the bump, a quarter
  double last = 1e9;
  for (double height : {0.4, 0.2, 0.1}) {
    TriMesh mesh = shapes::random_disk(8, 3);
    for (Vec3& p : mesh.positions) p.z() *= height;
    const OwnedDisk d = disk_of(mesh);
    SerialExecutor serial;
    const FlatAngles exact = flat_angles(d.disk, {}, {}, serial);
    const std::vector<FaceAngles> linear = solved(d.disk);
    double gap = 0;
    for (std::size_t t = 0; t < linear.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        gap = std::max(gap, std::abs(linear[t][i] - exact.angles[t][i]));
    EXPECT_LT(gap, last / 4);  // angles go with height^2: of fourth order here
    last = gap;
  }
}

TEST(LinearAngles, AreTheSameBytesForTwoThreads) {
  const OwnedDisk d = disk_of(shapes::random_disk(40, 5));
  TwoThreads two;
  EXPECT_EQ(solved(d.disk), linear_angles(d.disk, two));
}

TEST(Linabf, IsNoWorseThanTableOne) {  // and the same within 0.02 but on Isis, where it is lower
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  const std::vector<std::tuple<std::string, double, double>> printed{
      {"Isis_dABF", 2.12, 9.12}, {"Balls", 2.05, 2.34}, {"Cow_dABF", 2.01, 2.22}};
  for (const auto& [name, angle, area] : printed) {
    const OwnedDisk d = disk_of(read_obj(test_data() / "paper" / (name + ".obj")));
    SerialExecutor serial;
    const Solution s = linabf(d.disk, {}, serial);
    const Distortion got =
        measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, s.uv));
    EXPECT_LT(got.angle, angle + 0.02) << name;
    EXPECT_LT(got.area, area + 0.02) << name;
    EXPECT_EQ(s.iterations, 1);
    EXPECT_EQ(s.stop_reason, StopReason::direct);
    ASSERT_EQ(s.energy.size(), 2U);
    EXPECT_LT(s.energy[1], s.energy[0]) << name;
  }
}

}  // namespace
}  // namespace unwrapd::solve::methods
