// Charts that come from another process: what was packed is read, and nothing that is unsound.
#include "core/charts/packed_chart.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <string>

#include "core/base/error.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::charts {
namespace {

Chart whole_torus() {
  Chart chart = make_charts(shapes::surface_of(shapes::torus(6, 4)), SeamMode::automatic).charts[0];
  for (const Vec3& p : chart.mesh.positions) chart.start.emplace_back(p.x(), p.y());
  chart.least = Guarantee::flip_free;
  chart.avoid.assign(chart.halfedges.twin.size(), 0.25);
  return chart;
}

std::string packed(const Chart& chart) {
  BytePacker bytes;
  pack(bytes, chart);
  return bytes.take();
}

/// The chart in the bytes, all of them; nothing where they are refused.
std::optional<Chart> read(const std::string& text, const Chart& whole) {
  try {
    ByteUnpacker bytes(text);
    PartReader reader(whole);
    Chart chart = reader.next(bytes);
    reader.require_all();
    return chart;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::internal);
    return std::nullopt;
  }
}

/// Whether code that trusts it stays within its lists.
bool is_sound(const Chart& chart, const Chart& whole) {
  const auto vertices = static_cast<Index>(chart.mesh.positions.size());
  const auto sides = static_cast<Index>(3 * chart.mesh.faces.size());
  bool is_sound = chart.face_source.size() == chart.mesh.faces.size() &&
                  std::set(chart.face_source.begin(), chart.face_source.end()) ==
                      std::set(whole.face_source.begin(), whole.face_source.end());
  for (const Triangle& face : chart.mesh.faces)
    for (const Index v : face) is_sound &= v >= 0 && v < vertices;
  for (const Vec3& p : chart.mesh.positions) is_sound &= p.allFinite();
  is_sound &= static_cast<Index>(chart.halfedges.twin.size()) == sides;
  for (const Index h : chart.halfedges.twin) is_sound &= h >= kNoTwin && h < sides;
  for (const BoundaryLoop& loop : chart.loops)
    for (const Index h : loop) is_sound &= h >= 0 && h < sides;
  is_sound &= chart.start.empty() || static_cast<Index>(chart.start.size()) == vertices;
  is_sound &= chart.avoid.empty() || static_cast<Index>(chart.avoid.size()) == sides;
  is_sound &= chart.crease.empty() || static_cast<Index>(chart.crease.size()) == sides;
  return is_sound && chart.least <= Guarantee::bijective;
}

TEST(PackedChart, IsReadAsItWas) {
  const Chart whole = whole_torus();
  const std::string bytes = packed(whole);
  const std::optional<Chart> again = read(bytes, whole);
  ASSERT_TRUE(again);
  EXPECT_EQ(packed(*again), bytes);
  EXPECT_EQ(again->mesh.positions, whole.mesh.positions);
  EXPECT_EQ(again->loops, whole.loops);
  EXPECT_EQ(again->least, whole.least);
}

TEST(PackedChart, IsRefusedWhereItEndsEarly) {
  const Chart whole = whole_torus();
  const std::string bytes = packed(whole);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(read(bytes.substr(0, size), whole)) << size;
}

TEST(PackedChart, IsSoundWhateverByteWasChanged) {
  const Chart whole = whole_torus();
  const std::string bytes = packed(whole);
  int refused = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (const int change : {1, 0x40, 0x80, 0xff}) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ change);
      const std::optional<Chart> chart = read(changed, whole);
      if (chart)
        ASSERT_TRUE(is_sound(*chart, whole)) << at << " " << change;
      else
        ++refused;
    }
  EXPECT_GT(refused, 1000);
}

TEST(PackedChart, PartsHaveEachFaceOnce) {
  const Chart whole = whole_torus();
  const std::string bytes = packed(whole) + packed(whole);
  ByteUnpacker from(bytes);
  PartReader reader(whole);
  EXPECT_THROW(reader.require_all(), Error);
  reader.next(from);
  reader.require_all();
  EXPECT_THROW(reader.next(from), Error);
}

}  // namespace
}  // namespace unwrapd::charts
