// Gaps narrower than the lattice of what is written.
#include "core/guarantee/separate_rounded_boundaries.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.hpp"
#include "core/guarantee/keep_guarantee.hpp"
#include "core/guarantee/quantize_uvs.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "tests/api/error_of.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::guarantee {
namespace {

using shapes::disk_of;
using shapes::OwnedDisk;

constexpr std::size_t kAll = 1000;

/// A strip along each side of a slit, joined by a bridge at its end: n columns to the left, m to
/// the right, so that vertices of one side face edges of the other. z tells the right from the
/// left.
TriMesh fork(Index n, Index m) {
  TriMesh mesh;
  const auto strip = [&](Index count, double low, double high, double z) {
    const Index first = mesh.vertex_count();
    for (Index k = 0; k <= count; ++k)
      for (double y : {low, high}) mesh.positions.emplace_back(double(k) / double(count), y, z);
    for (Index k = 0; k < count; ++k) {
      const Index a = first + 2 * k;
      shapes::add_quad(mesh.faces, a, a + 2, a + 3, a + 1);
    }
    return first;
  };
  const Index low = strip(n, -0.5, 0, 0), high = strip(m, 0, 0.5, 1);
  const Index end = mesh.vertex_count();
  mesh.positions.emplace_back(1.5, 0, 0);
  const Index low_end = low + 2 * n, high_end = high + 2 * m;
  mesh.faces.push_back({low_end, end, low_end + 1});
  mesh.faces.push_back({low_end + 1, end, high_end});
  mesh.faces.push_back({high_end, end, high_end + 1});
  mesh.positions[std::size_t(high_end)].y() = 0.1;
  return mesh;
}

/// The fork turned, its prongs apart by a tenth of a step.
UvMap turned(const charts::Chart& chart, double angle) {
  UvMap uv;
  for (const Vec3& p : chart.mesh.positions) {
    const Vec2 q(0.5 * p.x(), 0.5 * p.y() + 0.1 * kUvStep * p.z());
    uv.emplace_back(0.4 + std::cos(angle) * q.x() - std::sin(angle) * q.y(),
                    0.4 + std::sin(angle) * q.x() + std::cos(angle) * q.y());
  }
  return uv;
}

std::size_t overlaps(const charts::Chart& chart, const UvMap& uv) {
  return measure::overlapping_pairs(chart.mesh.faces, uv, kAll).size();
}

void expect_on_lattice(const UvMap& uv) {
  for (const Vec2& u : uv)
    for (double x : {u.x(), u.y()}) EXPECT_EQ(x / kUvStep, std::round(x / kUvStep));
}

TEST(SeparateRoundedBoundaries, OpensWhatRoundingClosed) {
  const OwnedDisk owned = disk_of(fork(7, 5));
  int closed = 0;
  for (int k = 0; k < 40; ++k) {
    SCOPED_TRACE(k);
    const UvMap apart = turned(*owned.chart, 0.03 + 0.15 * k);
    ASSERT_EQ(overlaps(*owned.chart, apart), 0U);
    UvMap uv = apart;
    ASSERT_EQ(quantize_uvs(*owned.chart, {}, {}, uv), 0);
    if (overlaps(*owned.chart, uv) > 0) ++closed;
    EXPECT_TRUE(separate_rounded_boundaries(*owned.chart, {}, uv));
    EXPECT_EQ(overlaps(*owned.chart, uv), 0U);
    EXPECT_TRUE(measure::flipped_faces(owned.chart->mesh.faces, uv).empty());
    expect_on_lattice(uv);
    for (std::size_t v = 0; v < uv.size(); ++v) EXPECT_LT((uv[v] - apart[v]).norm(), 8 * kUvStep);
  }
  EXPECT_GT(closed, 10);  // else there is nothing to test
}

TEST(SeparateRoundedBoundaries, IsCancelled) {
  const OwnedDisk owned = disk_of(fork(7, 5));
  UvMap uv = turned(*owned.chart, 0.03);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(
      error_of([&] { separate_rounded_boundaries(*owned.chart, {}, uv, stop.get_token()); }).code(),
      ErrorCode::cancelled);
}

TEST(SeparateRoundedBoundaries, MovesNothingWhereVerticesAreHeldAndSaysSo) {
  const OwnedDisk owned = disk_of(fork(7, 5));
  const std::vector<char> constrained(owned.chart->mesh.positions.size(), 1);
  int failed = 0;
  for (int k = 0; k < 40; ++k) {
    UvMap uv = turned(*owned.chart, 0.03 + 0.15 * k);
    quantize_uvs(*owned.chart, constrained, {}, uv);
    const UvMap before = uv;
    const bool is_apart = overlaps(*owned.chart, uv) == 0;
    EXPECT_EQ(separate_rounded_boundaries(*owned.chart, constrained, uv), is_apart);
    EXPECT_EQ(uv, before);
    if (!is_apart) ++failed;
  }
  EXPECT_GT(failed, 10);
}

TEST(SeparateRoundedBoundaries, LetsAPromiseBeKeptThatRoundingWouldBreak) {
  const OwnedDisk owned = disk_of(fork(7, 5));
  for (int k = 0; k < 40; ++k) {
    UvMap uv = turned(*owned.chart, 0.03 + 0.15 * k);
    Written written;
    ASSERT_NO_THROW(written = keep_on_page(*owned.chart, {.guarantee = Guarantee::bijective}, uv));
    EXPECT_EQ(written.overlaps, 0);
    EXPECT_EQ(overlaps(*owned.chart, uv), 0U);
  }
}

}  // namespace
}  // namespace unwrapd::guarantee
