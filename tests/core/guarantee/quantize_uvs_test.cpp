#include "core/guarantee/quantize_uvs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/measure/orientation.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::guarantee {
namespace {

using shapes::disk_of;

std::size_t flips(const charts::Chart& chart, const UvMap& uv) {
  return measure::flipped_faces(chart.mesh.faces, uv).size();
}

UvMap on_page(const charts::Chart& chart, double side = 0.5) {
  UvMap uv;
  for (const Vec3& p : chart.mesh.positions)
    uv.emplace_back(0.25 + side * p.x(), 0.25 + side * p.y());
  return uv;
}

/// Both ways in which V is written are exact.
void expect_floats(const UvMap& uv) {
  for (const Vec2& u : uv)
    for (double x : {u.x(), u.y(), 1 - u.y()}) ASSERT_EQ(double(float(x)), x);
}

TEST(QuantizeUvs, MovesNothingByMoreThanHalfAStepWhereNothingIsSmall) {
  const auto owned = disk_of(shapes::random_disk(20, 3));
  const UvMap before = on_page(*owned.chart);
  UvMap uv = before;
  EXPECT_EQ(quantize_uvs(*owned.chart, {}, {}, uv), 0);
  expect_floats(uv);
  for (std::size_t v = 0; v < uv.size(); ++v)
    EXPECT_LE((uv[v] - before[v]).cwiseAbs().maxCoeff(), kUvStep / 2);
}

TEST(QuantizeUvs, OpensSliversThatRoundingWouldClose) {
  // rows of a grid pressed together to a thousandth of a step
  const auto owned = disk_of(shapes::grid(10, 10));
  for (double height : {1e-9, 1e-11, 1e-14}) {
    UvMap uv;
    for (const Vec3& p : owned.chart->mesh.positions)
      uv.emplace_back(0.25 + p.x() / 2,
                      0.25 + (p.y() < 0.45 ? p.y() / 2 : 0.225 + (p.y() - 0.45) * height));
    ASSERT_EQ(flips(*owned.chart, uv), 0U);
    EXPECT_EQ(quantize_uvs(*owned.chart, {}, {}, uv), 0) << height;
    EXPECT_EQ(flips(*owned.chart, uv), 0U);
    expect_floats(uv);
  }
}

TEST(QuantizeUvs, OpensARegionThatShrankToAPoint) {
  const auto owned = disk_of(shapes::grid(20, 20));
  UvMap uv;
  for (const Vec3& p : owned.chart->mesh.positions) {  // the middle shrunk by ten thousand
    const Vec2 d(p.x() - 0.5, p.y() - 0.5);
    const double r = d.norm();
    uv.push_back(Vec2(0.5, 0.5) + d * (r < 0.2 ? 1e-5 : 1e-5 + (r - 0.2) / r));
  }
  ASSERT_EQ(flips(*owned.chart, uv), 0U);
  const UvMap before = uv;
  EXPECT_EQ(quantize_uvs(*owned.chart, {}, {}, uv), 0);
  expect_floats(uv);
  for (std::size_t v = 0; v < uv.size(); ++v) EXPECT_LT((uv[v] - before[v]).norm(), 1e-3) << v;
}

TEST(QuantizeUvs, TurnsNeedleFansWithoutMovingFarVertices) {
  const auto owned = disk_of(shapes::cone(500, 2));
  UvMap uv;
  for (const Vec3& p : owned.chart->mesh.positions)
    uv.emplace_back(0.5 + 1e-6 * p.x(), 0.5 + 1e-6 * p.y());
  ASSERT_EQ(flips(*owned.chart, uv), 0U);
  EXPECT_EQ(quantize_uvs(*owned.chart, {}, {}, uv), 0);
  expect_floats(uv);
}

/// The rest of the chart reaches beyond the page and lies on a coarser lattice.
TEST(QuantizeUvs, WritesHeldVerticesAsExactlyAsTheyCanBe) {
  const auto owned = disk_of(shapes::random_disk(12, 5));
  for (const double side : {0.5, 1.9, 3.7, 40.0}) {
    const UvMap before = on_page(*owned.chart, side);
    UvMap uv = before;
    std::vector<char> constrained(uv.size(), 0);
    for (std::size_t v = 0; v < uv.size(); v += 3) constrained[v] = 1;
    EXPECT_EQ(quantize_uvs(*owned.chart, constrained, {}, uv), 0);
    expect_floats(uv);
    for (std::size_t v = 0; v < uv.size(); v += 3)
      for (const int i : {0, 1}) {
        const double reach = std::max({1.0, std::abs(before[v][i]), std::abs(1 - before[v][i])});
        EXPECT_LE(std::abs(uv[v][i] - before[v][i]),
                  kUvStep / 2 * std::exp2(std::ceil(std::log2(reach))))
            << side;
      }
  }
}

TEST(QuantizeUvs, SaysWhatHeldVerticesDoNotLeaveRoomFor) {
  const auto owned = disk_of(shapes::grid(1, 1));
  UvMap uv;
  for (const Vec3& p : owned.chart->mesh.positions)
    uv.emplace_back(0.5 + p.x() * 1e-9, 0.5 + p.y() * 1e-9);
  EXPECT_EQ(quantize_uvs(*owned.chart, std::vector<char>(4, 1), {}, uv), 2);
  expect_floats(uv);
}

}  // namespace
}  // namespace unwrapd::guarantee
