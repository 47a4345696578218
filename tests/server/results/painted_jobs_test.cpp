// Painted preferences from a request to its answer.
#include <gmock/gmock.h>

#include <array>
#include <sstream>

#include "tests/core/shapes.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::results {
namespace {

using testing::HasSubstr;

class PaintedJobs : public RunningServer {
 protected:
  httplib::Result unwrapped(const std::string& body, const std::string& query) {
    return client().Post("/v1/unwrap?" + query, body, "model/obj");
  }
};

/// Two boxes whose vertices have colours: green on the second.
std::string coloured_boxes(int green = 1) {
  std::ostringstream text;
  for (int box = 0; box < 2; ++box) {
    const TriMesh mesh = shapes::cube();
    for (const Vec3& p : mesh.positions)
      text << "v " << p.x() + 3 * box << ' ' << p.y() << ' ' << p.z() << " 0 "
           << (box == 1 ? green : 0) << " 0\n";
    for (const Triangle& face : mesh.faces)
      text << "f " << face[0] + 1 + 8 * box << ' ' << face[1] + 1 + 8 * box << ' '
           << face[2] + 1 + 8 * box << '\n';
  }
  return text.str();
}

/// The areas that the two boxes have on the page, by the text of the answer alone.
std::array<double, 2> areas_of(const std::string& obj) {
  std::vector<std::array<double, 2>> uv;
  std::array<double, 2> areas{};
  std::istringstream lines(obj);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key, corner;
    words >> key;
    if (key == "vt") words >> uv.emplace_back()[0] >> uv.back()[1];
    if (key != "f") continue;
    std::vector<std::array<double, 2>> at;
    int vertex = 0;
    for (; words >> corner; vertex = std::stoi(corner))
      at.push_back(uv.at(std::stoul(corner.substr(corner.find('/') + 1)) - 1));
    for (std::size_t k = 2; k < at.size(); ++k)
      areas[vertex > 8 ? 1 : 0] += std::abs((at[k - 1][0] - at[0][0]) * (at[k][1] - at[0][1]) -
                                            (at[k - 1][1] - at[0][1]) * (at[k][0] - at[0][0])) /
                                   2;
  }
  return areas;
}

TEST_F(PaintedJobs, GetTheTexelsThatArePainted) {
  start();
  const auto answer = unwrapped(coloured_boxes(), "texel_density=COLOR_0.g");
  ASSERT_EQ(answer->status, 200) << answer->body;
  const auto [plain, painted] = areas_of(answer->body);
  EXPECT_NEAR(painted / plain, 16, 0.05);
}

/// Stored answers are those of the request: the same mesh, painted and not, in any order.
TEST_F(PaintedJobs, ShareNoAnswerWithOthers) {
  start();
  const std::string body = coloured_boxes();
  const std::vector<std::string> queries{"", "texel_density=COLOR_0.g", "texel_density=COLOR_0.r",
                                         "seam_avoid=COLOR_0.g"};
  std::vector<std::string> first;
  for (const std::string& query : queries) first.push_back(unwrapped(body, query)->body);
  EXPECT_NE(first[0], first[1]);
  EXPECT_EQ(first[0], first[2]);  // there is no red
  for (std::size_t k = queries.size(); k-- > 0;)
    EXPECT_EQ(unwrapped(body, queries[k])->body, first[k]) << queries[k];
  EXPECT_NEAR(areas_of(unwrapped(coloured_boxes(0), queries[1])->body)[1] / areas_of(first[0])[0],
              1, 1e-3);  // other colours, the same positions
}

TEST_F(PaintedJobs, FailWithTheAttributesThatThereAre) {
  start();
  for (const std::string option : {"seam_avoid", "texel_density"}) {
    const auto answer = unwrapped(coloured_boxes(), option + "=_PAINT");
    expect_problem(answer, 422, "invalid_option");
    const api::Json problem = api::Json::parse(answer->body);
    EXPECT_EQ(problem.at("pointer"), "/" + option);
    EXPECT_THAT(problem.at("detail").get<std::string>(), HasSubstr("they have COLOR_0"));
  }
  expect_problem(unwrapped(grid_obj(4), "seam_avoid=COLOR_0"), 422, "invalid_option");
  EXPECT_EQ(client().Post("/v1/unwrap?seam_avoid=_A", grid_glb(4), "model/gltf-binary")->status,
            422);
  const auto job = client().Post("/v1/jobs?seam_avoid=_PAINT", {{"Prefer", "wait=20"}},
                                 coloured_boxes(), "model/obj");
  const api::Json failed = api::Json::parse(job->body);
  EXPECT_EQ(failed.at("state"), "failed");
  EXPECT_EQ(failed.at("problem").at("code"), "invalid_option");
  EXPECT_EQ(failed.at("options").at("seam_avoid"), "_PAINT");
}

}  // namespace
}  // namespace unwrapd::server::results
