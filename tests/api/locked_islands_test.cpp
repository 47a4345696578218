#include "api/locked_islands.hpp"

#include <gtest/gtest.h>

#include "api/options.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

TEST(LockedIslands, AreReadFromJsonAndWrittenBack) {
  const Json json =
      Json::parse(R"([{"face":7},{"face":0,"mesh":2},{"face":1,"turn":-30.5,"move":[0.25,-1]}])");
  const std::vector<LockedIsland> islands = locked_islands_from_json(json, "/locked_islands");
  ASSERT_EQ(islands.size(), 3U);
  EXPECT_EQ(islands[0].face, 7);
  EXPECT_EQ(islands[0].surface, 0);
  EXPECT_EQ(islands[1].surface, 2);
  EXPECT_TRUE(islands[1].stays());
  EXPECT_EQ(islands[2].turn, -30.5);
  EXPECT_EQ(islands[2].move, Vec2(0.25, -1));
  EXPECT_EQ(to_json(islands), Json::parse(R"([{"face":7,"mesh":0},{"face":0,"mesh":2},
      {"face":1,"mesh":0,"turn":-30.5,"move":[0.25,-1.0]}])"));
}

TEST(LockedIslands, AreRefusedAtTheFirstFault) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {R"({})", "/locked_islands"},
      {R"([5])", "/locked_islands/0"},
      {R"([{"mesh":1}])", "/locked_islands/0"},
      {R"([{"face":1},{"face":-1}])", "/locked_islands/1/face"},
      {R"([{"face":1.5}])", "/locked_islands/0/face"},
      {R"([{"face":1,"mesh":"a"}])", "/locked_islands/0/mesh"},
      {R"([{"face":1,"turn":"90"}])", "/locked_islands/0/turn"},
      {R"([{"face":1,"turn":[90]}])", "/locked_islands/0/turn"},
      {R"([{"face":1,"move":0.5}])", "/locked_islands/0/move"},
      {R"([{"face":1,"move":[0.5]}])", "/locked_islands/0/move"},
      {R"([{"face":1,"move":[0.5,null]}])", "/locked_islands/0/move"},
      {R"([{"face":1,"uv":[0,0]}])", "/locked_islands/0/uv"}};
  for (const auto& [text, where] : faults) {
    const Error error = error_of(
        [&, json = Json::parse(text)] { locked_islands_from_json(json, "/locked_islands"); });
    EXPECT_EQ(error.code(), ErrorCode::invalid_option) << text;
    EXPECT_EQ(error.where(), where) << text;
  }
}

TEST(LockedIslands, AndKeptEdgesAreOptionsThatExcludeOthers) {
  const Limits limits{.max_constraints = 2};
  const auto where = [&](const std::string& text) {
    return error_of([&] { parse_options_text(text, limits); }).where();
  };
  EXPECT_EQ(where(R"({"locked_islands":[{"face":0}]})"), "/locked_islands");
  EXPECT_EQ(where(R"({"repack_only":true,"locked_islands":[{"face":0},{"face":1},{"face":2}]})"),
            "/locked_islands");
  EXPECT_EQ(where(R"({"repack_only":true,"locked_islands":[{"face":0}],"group":"mesh"})"),
            "/group");
  EXPECT_EQ(where(R"({"repack_only":true,"locked_islands":[{"face":0},{"face":1,"turn":360.1}]})"),
            "/locked_islands/1/turn");
  EXPECT_EQ(where(R"({"repack_only":true,"locked_islands":[{"face":0,"move":[0,-1001]}]})"),
            "/locked_islands/0/move");
  EXPECT_EQ(where(R"({"keep_edges":[{"vertices":[0,1]}],"seam_edges":[{"vertices":[2,1,0]}]})"),
            "/keep_edges/0");
  EXPECT_EQ(where(R"({"keep_edges":[{"vertices":[0]}]})"), "/keep_edges/0/vertices");
  const JobOptions options =
      parse_options_text(R"({"repack_only":true,"locked_islands":[{"face":3}]})", limits);
  EXPECT_EQ(options.unwrap.locked_islands.at(0).face, 3);
}

}  // namespace
}  // namespace unwrapd::api
