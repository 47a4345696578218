// What the methods share that flatten the metric first and draw the map afterwards.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/methods.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/similarity.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve::methods {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

Distortion distortion_of(const Disk& disk, const UvMap& uv) {
  return measure::distortion(measure::distortion_sums(disk.rest, disk.faces, uv));
}

class Flattening : public testing::TestWithParam<Method> {
 protected:
  static Solution solved(const Disk& disk, const SolveWatch& watch = {}) {
    SerialExecutor serial;
    return other_method(disk, UnwrapOptions{.method = GetParam()}, watch, serial);
  }

  /// An answer without NaN, or an error that says what to do.
  static void expect_answer_or_error(const TriMesh& mesh, const std::string& what) {
    const OwnedDisk d = disk_of(mesh);
    try {
      const Solution s = solved(d.disk);
      ASSERT_EQ(s.uv.size(), d.disk.positions.size()) << what;
      for (const Vec2& u : s.uv) ASSERT_TRUE(u.allFinite()) << what;
      for (double e : s.energy) ASSERT_TRUE(std::isfinite(e)) << what;
      EXPECT_NEAR(measure::uv_area(d.disk.rest, d.disk.faces, s.uv), 1, 1e-3) << what;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::solver_failed) << what;
      EXPECT_GT(std::strlen(error.what()), 30U) << what;
    }
  }
};

/// Those of the mesh's own metric; ic has one of circles, see ic_test.cpp.
class ExactFlattening : public Flattening {};

TEST_P(ExactFlattening, IsIsometricOnDevelopableDisks) {
  for (const TriMesh& mesh :
       {shapes::grid(7, 5, 2, 1), shapes::half_cylinder(16, 8), shapes::cone_sector(20, 6),
        shapes::half_cylinder(3, 1), TriMesh{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}, {{0, 1, 2}}}}) {
    const OwnedDisk d = disk_of(mesh);
    const Solution s = solved(d.disk);
    const Distortion got = distortion_of(d.disk, s.uv);
    EXPECT_NEAR(got.angle, 2, 1e-9);
    EXPECT_NEAR(got.area, 2, 1e-9);
    EXPECT_EQ(got.flipped, 0);
  }
}

TEST_P(ExactFlattening, IsIsometricOnAPlaneWithHoles) {
  const TriMesh ring = shapes::annulus(24, 4, 0.3);
  const OwnedDisk d = disk_of(ring);
  const Distortion got = distortion_of(d.disk, solved(d.disk).uv);
  EXPECT_NEAR(got.angle, 2, 1e-9);
  EXPECT_NEAR(got.area, 2, 1e-9);
}

/// The stereographic map of the unit sphere from its south pole: conformal, and equally scaled all
/// along a circle about the north pole.
UvMap stereographic(const Disk& disk, const TriMesh& mesh) {
  UvMap uv;
  for (std::size_t v = 0; v < disk.positions.size(); ++v) {
    const Vec3& p = mesh.positions[v];
    uv.emplace_back(p.x() / (1 + p.z()), p.y() / (1 + p.z()));
  }
  UvMap scaled = uv;
  const double unit = 1 / std::sqrt(measure::uv_area(disk.rest, disk.faces, uv));
  for (Vec2& u : scaled) u *= unit;
  return scaled;
}

TEST_P(ExactFlattening, OfASphereCapTendsToTheStereographicMap) {
  double last_gap = 1e9, last_angle = 1e9;
  for (Index rings : {6, 12, 24}) {
    const TriMesh mesh = shapes::sphere_cap(6 * rings, rings, 1.2);
    const OwnedDisk d = disk_of(mesh);
    const Solution s = solved(d.disk);
    const double gap = gap_up_to_similarity(s.uv, stereographic(d.disk, d.chart->mesh));
    const double angle = distortion_of(d.disk, s.uv).angle - 2;
    EXPECT_LT(gap, 0.6 * last_gap) << rings;  // first order at least
    EXPECT_LT(angle, 0.6 * last_angle) << rings;
    last_gap = gap, last_angle = angle;
  }
  EXPECT_LT(last_gap, 0.01);
  EXPECT_LT(last_angle, 0.005);
}

TEST_P(Flattening, DoesNotDependOnScaleOrPlace) {
  const TriMesh mesh = shapes::random_disk(10, 3);
  const OwnedDisk d = disk_of(mesh);
  const UvMap expected = solved(d.disk).uv;
  for (double scale : {1e-6, 1e6}) {
    TriMesh other = mesh;
    for (Vec3& p : other.positions) p = scale * (p + Vec3(100, -200, 300));
    const OwnedDisk e = disk_of(std::move(other));
    EXPECT_LT(gap_up_to_similarity(solved(e.disk).uv, expected), 1e-6) << scale;
  }
}

TEST_P(Flattening, DoesNotDependOnTheOrderOfVerticesAndFaces) {
  const TriMesh mesh = shapes::random_disk(10, 4);
  const OwnedDisk a = disk_of(mesh), b = disk_of(shapes::shuffled(mesh, 9));
  const Distortion x = distortion_of(a.disk, solved(a.disk).uv);
  const Distortion y = distortion_of(b.disk, solved(b.disk).uv);
  EXPECT_NEAR(x.angle, y.angle, 1e-7);
  EXPECT_NEAR(x.area, y.area, 1e-6);
}

TEST_P(Flattening, GivesTheSameBytesForOneAndTwoThreads) {
  for (const TriMesh& mesh : {shapes::random_disk(25, 7), shapes::cylinder(20, 8)}) {
    const OwnedDisk d = disk_of(mesh);
    TwoThreads two;
    const UnwrapOptions options{.method = GetParam()};
    const Solution a = solved(d.disk), b = other_method(d.disk, options, {}, two);
    EXPECT_EQ(0, std::memcmp(a.uv.data(), b.uv.data(), a.uv.size() * sizeof(Vec2)));
    EXPECT_EQ(a.energy, b.energy);
  }
}

TEST_P(Flattening, EndsWhenItIsCancelled) {
  std::stop_source source;
  source.request_stop();
  const OwnedDisk d = disk_of(shapes::sphere_cap(20, 5));
  try {
    solved(d.disk, {.on_stage = {}, .loop = {.on_iteration = {}, .stop = source.get_token()}});
    FAIL() << "not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

TEST_P(Flattening, TellsOfEveryIterationAndCountsItsEnergies) {
  const OwnedDisk d = disk_of(shapes::random_disk(8, 2));
  std::vector<double> told;
  std::vector<Stage> stages;
  const Solution s =
      solved(d.disk, {.on_stage = [&](Stage stage) { stages.push_back(stage); },
                      .loop = {.on_iteration =
                                   [&](const Solution& so_far) {
                                     EXPECT_EQ(so_far.uv.size(), d.disk.positions.size());
                                     told.push_back(so_far.energy.back());
                                   },
                               .stop = {}}});
  ASSERT_EQ(s.energy.size(), std::size_t(s.iterations) + 1);
  EXPECT_EQ(told, std::vector<double>(s.energy.begin() + 1, s.energy.end()));
  EXPECT_EQ(stages.back(), Stage::solve);
}

TEST_P(Flattening, AnswersRandomDisks) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const OwnedDisk d = disk_of(shapes::random_disk(Index(2 + seed % 30), seed));
    const Solution s = solved(d.disk);
    const Distortion got = distortion_of(d.disk, s.uv);
    EXPECT_LT(got.angle, 2.3) << seed;
    EXPECT_EQ(got.flipped, 0) << seed;
    EXPECT_NEAR(measure::uv_area(d.disk.rest, d.disk.faces, s.uv), 1, 1e-9) << seed;
  }
}

/// A random disk with some of its faces taken out: holes of three edges and more.
TriMesh with_holes(Index n, unsigned seed) {
  TriMesh mesh = shapes::random_disk(n, seed);
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    const auto quad = Index(t / 2), column = quad % n, row = quad / n;
    if (column % 4 == 2 && row % 4 == 2 && row < n - 1 && column < n - 1 && (t % 2 == 0 || row > 4))
      continue;
    kept.push_back(mesh.faces[t]);
  }
  mesh.faces = std::move(kept);
  return mesh;
}

TEST_P(Flattening, AnswersRandomDisksWithHoles) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const OwnedDisk d = disk_of(with_holes(Index(8 + seed), seed));
    ASSERT_GT(d.disk.loops.size(), 3U);
    const Distortion got = distortion_of(d.disk, solved(d.disk).uv);
    EXPECT_LT(got.angle, 2.3) << seed;
    EXPECT_EQ(got.flipped, 0) << seed;
  }
}

/// Every third vertex drawn almost onto its neighbour: needles, and triangles of no height.
TriMesh with_needles(Index n, unsigned seed, double width) {
  TriMesh mesh = shapes::random_disk(n, seed);
  for (std::size_t v = 1; v < mesh.positions.size(); v += 3)
    mesh.positions[v] = mesh.positions[v - 1] + width * (mesh.positions[v] - mesh.positions[v - 1]);
  return mesh;
}

TEST_P(Flattening, AnswersNeedlesOrSaysWhyNot) {
  for (double width : {1e-2, 1e-4, 1e-8, 0.0})
    for (unsigned seed = 1; seed <= 5; ++seed)
      expect_answer_or_error(with_needles(9, seed, width), "width " + std::to_string(width));
}

TEST_P(Flattening, AnswersFansAndSpikesOrSaysWhyNot) {
  for (Index around : {3, 7, 500})
    for (double height : {0.0, 1.0, 100.0})
      expect_answer_or_error(shapes::cone(around, 1, height),
                             std::to_string(around) + " about an apex");
}

TEST_P(Flattening, AnswersDisksWithoutInnerVertices) {
  for (const TriMesh& mesh :
       {shapes::grid(1, 1), shapes::half_cylinder(40, 1),
        TriMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}}})
    expect_answer_or_error(mesh, "no inner vertex");
}

TEST_P(Flattening, AnswersClosedTubesOrSaysWhyNot) {
  for (double height : {0.1, 10.0, 1000.0})
    expect_answer_or_error(shapes::cylinder(12, 20, 1, height), "tube");
}

std::string name_of(const testing::TestParamInfo<Method>& method) {
  switch (method.param) {
    case Method::abf:
      return "abf";
    case Method::linabf:
      return "linabf";
    case Method::cp:
      return "cp";
    default:
      return method.param == Method::bff ? "bff" : "ic";
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, Flattening,
                         testing::Values(Method::abf, Method::linabf, Method::cp, Method::bff,
                                         Method::ic),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Methods, ExactFlattening,
                         testing::Values(Method::abf, Method::linabf, Method::cp, Method::bff),
                         name_of);

}  // namespace
}  // namespace unwrapd::solve::methods
