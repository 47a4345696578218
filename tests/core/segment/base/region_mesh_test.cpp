#include "core/segment/base/region_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/core/segment/cap_with_flap.hpp"

namespace unwrapd::segment {
namespace {

/// Vertices that faces of both kinds have, by sets.
TEST(MovingPart, HoldsWhatOtherFacesHaveToo) {
  const CapWithFlap cap;
  const RegionMesh region = region_mesh(cap.surface, {}, cap.both.faces);
  const MovingPart part = moving_part(region, cap.both.mapped, cap.both.uv);
  EXPECT_EQ(part.faces.size(), 100U);
  EXPECT_TRUE(std::ranges::is_sorted(part.faces));
  for (std::size_t t = cap.both.mapped; t < cap.both.faces.size(); ++t)
    EXPECT_TRUE(std::ranges::binary_search(part.faces, static_cast<Index>(t)));
  std::map<Index, Vec2> still;
  std::set<Index> moving;
  for (std::size_t t = 0; t < region.mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index v = region.mesh.faces[t][i];
      if (std::ranges::binary_search(part.faces, static_cast<Index>(t)))
        moving.insert(v);
      else
        still.emplace(v, cap.both.uv[t][i]);
    }
  EXPECT_EQ(std::set<Index>(part.vertices.begin(), part.vertices.end()), moving);
  for (std::size_t k = 1; k < part.vertices.size(); ++k)
    EXPECT_LT(region.rank[std::size_t(part.vertices[k - 1])],
              region.rank[std::size_t(part.vertices[k])]);
  std::map<Index, Vec2> held;
  for (const auto& [v, at] : part.held.hard) held.emplace(part.vertices[std::size_t(v)], at);
  std::erase_if(still, [&](const auto& vertex) { return !moving.contains(vertex.first); });
  EXPECT_EQ(held, still);
  EXPECT_FALSE(held.empty());
}

TEST(MovingPart, IsAllWhereNothingIsMapped) {
  const CapWithFlap cap;
  const RegionMesh region = region_mesh(cap.surface, {}, cap.both.faces);
  const MovingPart part = moving_part(region, 0, cap.both.uv);
  EXPECT_EQ(part.faces.size(), cap.both.faces.size());
  EXPECT_TRUE(part.held.empty());
}

}  // namespace
}  // namespace unwrapd::segment
