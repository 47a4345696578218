// ABF++: its constraints by formulas of their own, its optimum by a dense Lagrangian.
#include "core/solve/methods/abf.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>
#include <tuple>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/odd_disks.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve::methods {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

FlatAngles flat(const Disk& disk) {
  SerialExecutor serial;
  return flat_angles(disk, {}, {}, serial);
}

/// 0: inner; 1: on the longest loop; k > 1: on hole k.
std::vector<std::size_t> loop_of(const Disk& disk) {
  std::vector<std::size_t> loop(disk.positions.size(), 0);
  for (std::size_t k = 0; k < disk.loops.size(); ++k)
    for (Index h : disk.loops[k]) loop[std::size_t(disk.faces[std::size_t(h / 3)][h % 3])] = k + 1;
  return loop;
}

/// All constraints of a disk as one vector: triangles, angle sums at inner vertices, products of
/// sines there (as a quotient, less 1), then the same two for every hole.
Eigen::VectorXd constraints(const Disk& disk, const std::vector<FaceAngles>& angles) {
  const std::vector<std::size_t> loop = loop_of(disk);
  std::vector<double> values;
  for (const FaceAngles& a : angles) values.push_back(a[0] + a[1] + a[2] - std::numbers::pi);
  const auto walk = [&](double turn, auto is_met) {
    double sum = 0, quotient = 1;
    for (std::size_t t = 0; t < angles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        if (!is_met(std::size_t(disk.faces[t][i]))) continue;
        sum += angles[t][i];
        quotient *= std::sin(angles[t][(i + 1) % 3]) / std::sin(angles[t][(i + 2) % 3]);
      }
    values.push_back(sum - turn), values.push_back(quotient - 1);
  };
  for (std::size_t v = 0; v < loop.size(); ++v)
    if (loop[v] == 0) walk(2 * std::numbers::pi, [&](std::size_t w) { return w == v; });
  for (std::size_t k = 1; k < disk.loops.size(); ++k)
    walk(double(disk.loops[k].size() + 2) * std::numbers::pi,
         [&](std::size_t w) { return loop[w] == k + 1; });
  return Eigen::Map<Eigen::VectorXd>(values.data(), Index(values.size()));
}

/// Their derivatives by central differences: a row a constraint, a column a corner.
Eigen::MatrixXd constraint_rows(const Disk& disk, std::vector<FaceAngles> angles) {
  constexpr double h = 1e-6;
  Eigen::MatrixXd rows(constraints(disk, angles).size(), 3 * Index(angles.size()));
  for (std::size_t t = 0; t < angles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const double at = angles[t][i];
      angles[t][i] = at + h;
      const Eigen::VectorXd above = constraints(disk, angles);
      angles[t][i] = at - h;
      rows.col(3 * Index(t) + Index(i)) = (above - constraints(disk, angles)) / (2 * h);
      angles[t][i] = at;
    }
  return rows;
}

Eigen::VectorXd stacked(const std::vector<FaceAngles>& angles) {
  Eigen::VectorXd x(3 * Index(angles.size()));
  for (std::size_t t = 0; t < angles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) x[3 * Index(t) + Index(i)] = angles[t][i];
  return x;
}

TEST(Angles, AreThoseBetweenTheSidesInSpace) {
  const OwnedDisk d = disk_of(shapes::random_disk(8, 1));
  const std::vector<FaceAngles> angles = mesh_angles(d.disk);
  for (std::size_t t = 0; t < angles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = [&](std::size_t k) {
        return d.disk.positions[std::size_t(d.disk.faces[t][(i + k) % 3])];
      };
      const double cosine = (at(1) - at(0)).normalized().dot((at(2) - at(0)).normalized());
      EXPECT_NEAR(angles[t][i], std::acos(cosine), 1e-7);
    }
}

TEST(Angles, AreTargetsOnceInnerVerticesAreScaledToAFullTurn) {
  const OwnedDisk d = disk_of(shapes::cone(9, 3, 1));
  const std::vector<FaceAngles> own = mesh_angles(d.disk), target = target_angles(d.disk);
  std::vector<double> sum(d.disk.positions.size(), 0.0), own_sum = sum;
  for (std::size_t t = 0; t < target.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      sum[std::size_t(d.disk.faces[t][i])] += target[t][i];
      own_sum[std::size_t(d.disk.faces[t][i])] += own[t][i];
    }
  const std::vector<std::size_t> loop = loop_of(d.disk);
  for (std::size_t v = 0; v < sum.size(); ++v)
    EXPECT_NEAR(sum[v], loop[v] == 0 ? 2 * std::numbers::pi : own_sum[v], 1e-9) << v;
}

TEST(Angles, StayBelowAHalfTurnWhereScalingWouldLeadBeyond) {
  TriMesh spike{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.1, 40}},
                {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  spike.positions[2] = Vec3(0.001, 0.002, 0);
  const OwnedDisk d = disk_of(spike);
  for (const FaceAngles& a : target_angles(d.disk))
    for (double x : a) EXPECT_TRUE(x > 0 && x < std::numbers::pi) << x;
}

TEST(AngleSystem, FindsNothingToMendInThePlane) {
  for (const TriMesh& mesh :
       {shapes::grid(5, 4), shapes::annulus(12, 3), shapes::pierced_disk(9, 1)}) {
    TriMesh plane = mesh;
    for (Vec3& p : plane.positions) p.z() = 0;
    const OwnedDisk d = disk_of(plane);
    SerialExecutor serial;
    EXPECT_LT(AngleSystem(d.disk, serial).misfit(mesh_angles(d.disk)).largest(), 1e-12);
  }
}

/// min curvature d^2 / 2 + slope d with the constraints met to first order, as one dense system.
Eigen::VectorXd dense_step(const Disk& disk, const std::vector<FaceAngles>& angles,
                           const AngleModel& model) {
  const Eigen::MatrixXd rows = constraint_rows(disk, angles);
  const Index n = Index(rows.cols()), m = Index(rows.rows());
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + m, n + m);
  system.topLeftCorner(n, n) = stacked(model.curvature).asDiagonal();
  system.topRightCorner(n, m) = rows.transpose();
  system.bottomLeftCorner(m, n) = rows;
  Eigen::VectorXd rhs(n + m);
  rhs << -stacked(model.slope), -constraints(disk, angles);
  return system.fullPivLu().solve(rhs).head(n);
}

TEST(AngleSystem, StepsLikeTheDenseLagrangian) {  // which has the triangles' multipliers too
  for (const TriMesh& mesh : {shapes::random_disk(4, 2), shapes::annulus(7, 3, 0.4)}) {
    const OwnedDisk d = disk_of(mesh);
    // the wheel in logarithms and as a quotient agree to first order where it is closed already
    const std::vector<FaceAngles> angles = flat(d.disk).angles;
    AngleModel model{angles, angles};
    std::mt19937 rng(3);
    std::uniform_real_distribution<double> slope(-0.1, 0.1), curvature(0.5, 4);
    for (std::size_t t = 0; t < angles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        model.slope[t][i] = slope(rng), model.curvature[t][i] = curvature(rng);
    SerialExecutor serial;
    AngleSystem system(d.disk, serial);
    const Eigen::VectorXd got = stacked(system.step(angles, model));
    EXPECT_GT(got.norm(), 1e-2);
    EXPECT_LT((got - dense_step(d.disk, angles, model)).norm(), 1e-6 * got.norm());
  }
}

void expect_flat(const Disk& disk, const FlatAngles& flat, const std::string& what) {
  for (const FaceAngles& a : flat.angles)
    for (double x : a) ASSERT_TRUE(x > 0 && x < std::numbers::pi) << what << ": " << x;
  EXPECT_LT(constraints(disk, flat.angles).cwiseAbs().maxCoeff(), 1e-6) << what;
}

TEST(FlatAngles, MeetTheirConstraintsOnRandomDisks) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const OwnedDisk d = disk_of(shapes::random_disk(Index(1 + seed), seed));
    const FlatAngles f = flat(d.disk);
    expect_flat(d.disk, f, std::to_string(seed));
    EXPECT_EQ(f.stop_reason, StopReason::converged) << seed;
    EXPECT_LE(f.iterations, 10) << seed;
  }
}

TEST(FlatAngles, MeetTheirConstraintsAroundHoles) {
  for (const TriMesh& mesh :
       {shapes::cylinder(10, 6), shapes::pierced_disk(9, 2), shapes::pierced_disk(17, 3)}) {
    const OwnedDisk d = disk_of(mesh);
    expect_flat(d.disk, flat(d.disk), std::to_string(mesh.faces.size()));
  }
}

TEST(FlatAngles, MeetTheirConstraintsOnHardDisks) {
  for (const auto& [name, mesh] : odd::hard_disks()) {
    const OwnedDisk d = disk_of(mesh);
    expect_flat(d.disk, flat(d.disk), name);
  }
}

TEST(FlatAngles,
     CannotBeBetteredToFirstOrder) {  // the energy's slope lies in the constraints' span
  for (const TriMesh& mesh :
       {shapes::random_disk(5, 4), shapes::sphere_cap(8, 3, 1.5), shapes::cylinder(6, 3)}) {
    const OwnedDisk d = disk_of(mesh);
    const FlatAngles f = flat(d.disk);
    const std::vector<FaceAngles> target = target_angles(d.disk);
    const Eigen::ArrayXd beta = stacked(target), alpha = stacked(f.angles);
    const Eigen::VectorXd slope = (alpha - beta) / beta.square();
    const Eigen::MatrixXd across = constraint_rows(d.disk, f.angles).transpose();
    const Eigen::VectorXd multipliers = across.colPivHouseholderQr().solve(slope);
    EXPECT_GT(slope.norm(), 1e-3);
    EXPECT_LT((slope - across * multipliers).norm(), 1e-6 * slope.norm());
  }
}

TEST(FlatAngles, KeepAwayFromZeroOnSpheresButForAPinhole) {
  for (const auto& [around, rings, angle] :
       {std::tuple{40, 30, 3.1}, {20, 12, 3.1}, {24, 40, 3.13}}) {
    const OwnedDisk d = disk_of(shapes::sphere_cap(around, rings, angle));
    const FlatAngles f = flat(d.disk);
    expect_flat(d.disk, f, "pinhole");
    EXPECT_EQ(f.stop_reason, StopReason::converged) << angle;
    EXPECT_LE(f.iterations, 20);
    const UvMap uv = map_of_angles(d.disk, f.angles);
    const Distortion map =
        measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, uv));
    EXPECT_LT(map.angle, 3);  // 4 to 105 where angles are let go to 0
    EXPECT_EQ(map.flipped, 0);
  }
}

TEST(FlatAngles, AreTheSameBytesForTwoThreads) {
  const OwnedDisk d = disk_of(shapes::random_disk(40, 5));
  TwoThreads two;
  EXPECT_EQ(flat(d.disk).angles, flat_angles(d.disk, {}, {}, two).angles);
}

TEST(FlatAngles, StopWithinAnIterationOfBeingAskedTo) {
  const OwnedDisk d = disk_of(shapes::sphere_cap(20, 8, 2));
  std::stop_source source;
  int told = 0;
  SerialExecutor serial;
  const auto stop_at_two = [&](const FlatAngles& f) {
    EXPECT_EQ(f.iterations, ++told);
    if (told == 2) source.request_stop();
  };
  try {
    flat_angles(d.disk, source.get_token(), stop_at_two, serial);
    FAIL() << "not cancelled";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(told, 2);
}

TEST(Abf, LaysOutTheFlatAngles) {  // a triangle of the map has the angles that were solved for
  const OwnedDisk d = disk_of(shapes::random_disk(7, 6));
  SerialExecutor serial;
  const Solution s = abf(d.disk, {}, serial);
  const FlatAngles f = flat(d.disk);
  for (std::size_t t = 0; t < f.angles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = [&](std::size_t k) {
        return s.uv[std::size_t(d.disk.faces[t][(i + k) % 3])];
      };
      const Vec2 x = at(1) - at(0), y = at(2) - at(0);
      const double angle = std::atan2(x.x() * y.y() - x.y() * y.x(), x.dot(y));
      EXPECT_NEAR(angle, f.angles[t][i], 1e-8);
    }
}

TEST(Abf, KeepsAnglesOnTheModelsOfThePaper) {  // Table 1, dABF, D_angle within 0.02
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  const std::vector<std::pair<std::string, double>> printed{
      {"Isis_dABF", 2.08}, {"Balls", 2.06}, {"Cow_dABF", 2.01}, {"Beetle_ABF", 2.00}};
  for (const auto& [name, angle] : printed) {
    const OwnedDisk d = disk_of(read_obj(test_data() / "paper" / (name + ".obj")));
    SerialExecutor serial;
    const Solution s = abf(d.disk, {}, serial);
    const Distortion got =
        measure::distortion(measure::distortion_sums(d.disk.rest, d.disk.faces, s.uv));
    EXPECT_NEAR(got.angle, angle, 0.02) << name;
    EXPECT_EQ(got.flipped, 0) << name;
    EXPECT_EQ(s.stop_reason, StopReason::converged) << name;
    EXPECT_LE(s.iterations, 10) << name;
  }
}

}  // namespace
}  // namespace unwrapd::solve::methods
