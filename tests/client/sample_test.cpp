#include "client/sample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>

#include "api/json.hpp"

namespace unwrapd::client {
namespace {

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(Sample, IsTwoWholeChunks) {
  const std::string glb = sample_glb();
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(word_at(glb, 8), glb.size());
  const std::size_t json_bytes = word_at(glb, 12);
  EXPECT_EQ(json_bytes % 4, 0);
  EXPECT_EQ(20 + json_bytes + 8 + word_at(glb, 20 + json_bytes), glb.size());
}

TEST(Sample, IsADiskWithOneHole) {
  const std::string glb = sample_glb();
  const auto json = api::Json::parse(glb.substr(20, word_at(glb, 12)));
  const std::size_t start = 28 + word_at(glb, 12);
  const auto vertices = json["accessors"][0]["count"].get<std::size_t>();
  const auto corners = json["accessors"][2]["count"].get<std::size_t>();
  const auto offset = start + json["bufferViews"][2]["byteOffset"].get<std::size_t>();
  const auto index = [&](std::size_t corner) {
    std::uint16_t value = 0;
    std::memcpy(&value, glb.data() + offset + 2 * corner, 2);
    return value;
  };
  std::map<std::pair<int, int>, int> edges;  // with the number of faces at each
  for (std::size_t corner = 0; corner < corners; ++corner) {
    const std::uint16_t a = index(corner);
    const std::uint16_t b = index(corner % 3 == 2 ? corner - 2 : corner + 1);
    ASSERT_LT(a, vertices);
    ++edges[std::minmax(a, b)];
  }
  int boundary = 0;
  for (const auto& [edge, faces] : edges) {
    ASSERT_LE(faces, 2);
    boundary += faces == 1 ? 1 : 0;
  }
  EXPECT_EQ(corners / 3, 20'164);
  EXPECT_EQ(static_cast<long>(vertices) - static_cast<long>(edges.size() - corners / 3), 0);
  EXPECT_EQ(boundary, 2 * 142);  // the rim and the hole
}

TEST(Sample, HasUnitNormals) {
  const std::string glb = sample_glb();
  const auto json = api::Json::parse(glb.substr(20, word_at(glb, 12)));
  const std::size_t start = 28 + word_at(glb, 12);
  const auto offset = start + json["bufferViews"][1]["byteOffset"].get<std::size_t>();
  for (std::size_t vertex = 0; vertex < json["accessors"][1]["count"]; ++vertex) {
    float n[3];
    std::memcpy(n, glb.data() + offset + 12 * vertex, 12);
    EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-5);
  }
}

}  // namespace
}  // namespace unwrapd::client
