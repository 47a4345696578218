// What a guarantee promises, tested on the bytes that are written: UVs as floats, read back by
// readers of the tests' own, their orientation by integers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/asset/support.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/shapes.hpp"
#include "tests/pipeline/written.hpp"

namespace unwrapd {
namespace {

struct Answer {
  std::string glb, obj;
  Report report;
};

/// Through everything: OBJ in, OBJ and GLB out.
Answer answer(const std::string& obj, const UnwrapOptions& options) {
  const asset::Asset asset = asset::read({.document = obj, .buffers = {}}, {});
  SerialExecutor serial;
  const Unwrapped u = unwrap(asset.surfaces(), options, {}, serial);
  return {asset::write(asset, u.surfaces, asset::Format::glb),
          asset::write(asset, u.surfaces, asset::Format::obj), u.report};
}

void expect_no_flips(const std::string& obj, const UnwrapOptions& options = {}) {
  const Answer a = answer(obj, options);
  EXPECT_EQ(flips(triangles_of_glb(a.glb)), 0U);
  EXPECT_EQ(flips(triangles_of_obj(a.obj)), 0U);
  EXPECT_EQ(a.report.distortion.flipped, 0);
  EXPECT_EQ(a.report.guarantee, options.guarantee);
}

/// Long thin triangles: the grid of random_disk pressed together, with a few rows pressed harder.
TriMesh slivers(Index n, unsigned seed, double thinness) {
  TriMesh mesh = shapes::random_disk(n, seed);
  std::mt19937 rng(seed);
  for (Vec3& p : mesh.positions)
    if (rng() % 3 == 0) p = Vec3(p.x(), thinness * p.y(), thinness * p.z());
  return mesh;
}

/// A square spiral, as wide as one cell: developable, all boundary.
TriMesh spiral_strip(int cells) {
  TriMesh mesh;
  int x = 0, y = 0, run = 1;
  std::map<std::pair<int, int>, Index> number;
  const auto id = [&](int i, int j) {
    const auto [at, is_new] = number.try_emplace({i, j}, mesh.vertex_count());
    if (is_new) mesh.positions.emplace_back(i, j, 0.3 * std::sin(0.7 * i) * std::cos(0.4 * j));
    return at->second;
  };
  for (int turns = 0; cells > 0; ++turns, run += 2 * (turns % 2 == 0))
    for (int k = 0; k < run && cells > 0; ++k, --cells) {
      shapes::add_quad(mesh.faces, id(x, y), id(x + 1, y), id(x + 1, y + 1), id(x, y + 1));
      (turns % 2 == 0 ? x : y) += turns % 4 < 2 ? 1 : -1;
    }
  return mesh;
}

TEST(Guarantee, NoTriangleIsFlippedInWhatIsWrittenOfRandomDisks) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE(seed);
    expect_no_flips(obj_text(shapes::random_disk(Index(2 + (seed * 7) % 30), seed)));
  }
}

TEST(Guarantee, HoldsForSliversNeedlesFansAndStrips) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    expect_no_flips(obj_text(slivers(Index(4 + 3 * seed), seed, 1e-3)));
    expect_no_flips(obj_text(slivers(Index(4 + 3 * seed), seed, 1e-6)));
  }
  expect_no_flips(obj_text(shapes::cone(2000, 1, 3)));
  expect_no_flips(obj_text(shapes::cone(400, 20, 0.01)));
  expect_no_flips(obj_text(spiral_strip(300)));
  expect_no_flips(obj_text(shapes::grid(400, 1, 1, 1e-5)));
}

TEST(Guarantee, HoldsWithSeveralBoundariesAndForClosedSurfaces) {
  for (const TriMesh& mesh :
       {shapes::annulus(30, 4), shapes::cylinder(40, 20, 1, 9), shapes::sphere(3), shapes::cube(3),
        shapes::torus(24, 12), shapes::pierced_bar(3), shapes::sphere_cap(40, 25, 3.1)})
    expect_no_flips(obj_text(mesh));
}

TEST(Guarantee, HoldsForEveryMethodThatMayShrinkARegion) {
  for (Method method : {Method::asap, Method::hybrid, Method::arap}) {
    expect_no_flips(obj_text(shapes::sphere_cap(40, 40, 3.13)), {.method = method});
    expect_no_flips(obj_text(shapes::cylinder(20, 60, 0.1, 6)), {.method = method});
  }
}

TEST(Guarantee, OfTheVirtualBoundaryHoldsAsWell) {
  for (unsigned seed = 0; seed < 8; ++seed)
    expect_no_flips(obj_text(shapes::random_disk(Index(3 + 3 * seed), seed)),
                    {.repair = RepairMethod::virtual_boundary});
}

/// Area of the part of a that b covers too (clipping).
double common_area(const UvTriangle& a, const UvTriangle& b) {
  std::vector<Vec2> p(a.corner.begin(), a.corner.end());
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 from = b.corner[i], d = b.corner[(i + 1) % 3] - from;
    const auto side = [&](const Vec2& q) {
      return d.x() * (q - from).y() - d.y() * (q - from).x();
    };
    std::vector<Vec2> cut;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Vec2 &q = p[k], &r = p[(k + 1) % p.size()];
      if (side(q) >= 0) cut.push_back(q);
      if (side(q) * side(r) < 0) cut.emplace_back(q + (r - q) * side(q) / (side(q) - side(r)));
    }
    p = cut;
  }
  double area = 0;
  for (std::size_t k = 2; k < p.size(); ++k) {
    const Vec2 u = p[k - 1] - p[0], v = p[k] - p[0];
    area += (u.x() * v.y() - u.y() * v.x()) / 2;
  }
  return area;
}

/// A turn and a half, which ARAP lays upon itself.
TriMesh helix() {
  return shapes::mapped_grid(60, 3, shapes::Wrap::none, [](double u, double v) {
    const double r = 1 + v, angle = 9 * u;
    return Vec3(r * std::cos(angle), r * std::sin(angle), u);
  });
}

TEST(Guarantee, OfInjectivityLeavesNoPairThatOverlaps) {
  UnwrapOptions options{.guarantee = Guarantee::bijective};
  for (const TriMesh& mesh : {helix(), shapes::random_disk(12, 1), shapes::sphere(2)}) {
    const Answer a = answer(obj_text(mesh), options);
    const std::vector<UvTriangle> triangles = triangles_of_glb(a.glb);
    EXPECT_EQ(flips(triangles), 0U);
    for (std::size_t s = 0; s < triangles.size(); ++s)
      for (std::size_t t = s + 1; t < triangles.size(); ++t)
        ASSERT_LT(common_area(triangles[s], triangles[t]), 1e-13) << s << ' ' << t;
    for (const ChartReport& chart : a.report.charts) EXPECT_EQ(chart.overlaps, 0);
  }
  const Report cut = answer(obj_text(helix()), options).report;
  EXPECT_EQ(cut.charts.size(), 2U);  // bent to a spiral it would have many times the energy
  EXPECT_LT(cut.charts[0].mending.energy_rise, 0.05);
  options.max_charts = 1;
  const Report parted = answer(obj_text(helix()), options).report;
  EXPECT_EQ(parted.charts.size(), 1U);  // its boundaries part, it is not split
  EXPECT_EQ(parted.charts[0].mending.parts, 1);
  EXPECT_GT(parted.charts[0].mending.overlaps, 0);
}

TEST(Guarantee, OfInjectivityKeepsChartsWholeThatConstraintsDraw) {
  UnwrapOptions options{.guarantee = Guarantee::bijective};
  options.constraints = {{.surface = 0, .vertex = 0, .uv = Vec2(0.2, 0.2), .weight = 1},
                         {.surface = 0, .vertex = 100, .uv = Vec2(0.6, 0.6), .weight = 1}};
  const Answer a = answer(obj_text(helix()), options);
  ASSERT_EQ(a.report.charts.size(), 1U);
  EXPECT_EQ(a.report.charts[0].mending.parts, 1);
  EXPECT_EQ(a.report.charts[0].overlaps, 0);
  EXPECT_GT(a.report.charts[0].mending.overlaps, 0);
}

TEST(Guarantee, OfNothingReportsWhatIsFlipped) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  const std::string obj = asset::test::bytes_of(test_data() / "disk" / "hand_lowres.obj");
  const Answer raw = answer(obj, {.stop = {.iterations = 10}, .guarantee = Guarantee::none});
  EXPECT_GT(raw.report.distortion.flipped, 0);
  EXPECT_EQ(raw.report.charts[0].mending.flips, 0);
  const Answer kept = answer(obj, {.stop = {.iterations = 10}});
  EXPECT_EQ(kept.report.distortion.flipped, 0);
  EXPECT_GT(kept.report.charts[0].mending.flips, 0);
  // a mended map has no needles: D_angle falls from 10.1 to 7.1, the energy pays for it (ADR 0032)
  EXPECT_LT(kept.report.distortion.angle, 8);
  EXPECT_LT(kept.report.charts[0].mending.energy_rise, 0.03);
}

TEST(Guarantee, HoldsForThePapersModelsAndForAGlb) {
  if (test_data().empty()) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  for (const char* name : {"Balls.obj", "Beetle_ABF.obj", "Cow_dABF.obj", "Isis_dABF.obj"}) {
    SCOPED_TRACE(name);
    expect_no_flips(asset::test::bytes_of(test_data() / "paper" / name));
  }
  const std::string glb = asset::test::bytes_of(test_data() / "gltf" / "pmndrs" / "suzi.glb");
  const asset::Asset asset =
      asset::read({.document = glb, .buffers = {}}, {}, {.compression = Compression::none});
  SerialExecutor serial;
  const Unwrapped u = unwrap(asset.surfaces(), {}, {}, serial);
  EXPECT_EQ(flips(triangles_of_glb(asset::write(asset, u.surfaces, asset::Format::glb))), 0U);
}

}  // namespace
}  // namespace unwrapd
