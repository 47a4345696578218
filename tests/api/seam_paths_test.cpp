#include "api/seam_paths.hpp"

#include <gtest/gtest.h>

#include "error_of.hpp"

namespace unwrapd::api {
namespace {

TEST(SeamPaths, AreReadAndWrittenUnchanged) {
  const Json json = Json::parse(R"([{"vertices":[3,4,9],"mesh":2},{"vertices":[0,1],"mesh":0}])");
  const std::vector<SeamPath> paths = seam_paths_from_json(json, "seam_edges");
  ASSERT_EQ(paths.size(), 2U);
  EXPECT_EQ(paths[0].surface, 2);
  EXPECT_EQ(paths[0].vertices, (std::vector<Index>{3, 4, 9}));
  EXPECT_EQ(to_json(paths), json);
}

TEST(SeamPaths, BelongToTheFirstMeshWhenNoneIsNamed) {
  const Json json = Json::parse(R"([{"vertices":[0,1]}])");
  EXPECT_EQ(seam_paths_from_json(json, "seam_edges").at(0).surface, 0);
}

TEST(SeamPaths, AreRefusedAtThePlaceThatIsWrong) {
  const std::vector<std::pair<const char*, const char*>> wrong = {
      {R"({})", "/seam_edges"},
      {R"([5])", "/seam_edges/0"},
      {R"([{"mesh":1}])", "/seam_edges/0"},
      {R"([{"vertices":[1]}])", "/seam_edges/0/vertices"},
      {R"([{"vertices":[0,1]},{"vertices":[1,2.5]}])", "/seam_edges/1/vertices/1"},
      {R"([{"vertices":[0,-1]}])", "/seam_edges/0/vertices/1"},
      {R"([{"vertices":[0,1],"mesh":"a"}])", "/seam_edges/0/mesh"},
      {R"([{"vertices":[0,1],"length":2}])", "/seam_edges/0/length"}};
  for (const auto& [text, pointer] : wrong) {
    const Error error =
        error_of([&, json = Json::parse(text)] { seam_paths_from_json(json, "seam_edges"); });
    EXPECT_EQ(error.code(), ErrorCode::invalid_option) << text;
    EXPECT_EQ(error.where(), pointer) << text;
  }
}

}  // namespace
}  // namespace unwrapd::api
