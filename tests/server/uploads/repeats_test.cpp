// A question asked again is answered by the files that are there: it takes no room, and nothing
// from others.
#include <gmock/gmock.h>

#include "server/base/identity.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::uploads {
namespace {

class Repeats : public RunningServer {
 protected:
  Repeats() {
    config_.workers = 1;
    config_.disk.min_free_bytes = 0;
    config_.admin = http::Address{"127.0.0.1", 0};
  }
  [[nodiscard]] double stored_bytes() const {
    httplib::Client admin("127.0.0.1", *service_->admin_port());
    const std::string text = admin.Get("/metrics")->body;
    const std::string name = "\nunwrapd_stored_bytes ";
    return std::stod(text.substr(text.find(name) + name.size()));
  }
  std::string repeat(const std::string& mesh) {
    const api::Json asked = {{"mesh", sha256(mesh)}, {"options", {{"stop", {{"iterations", 2}}}}}};
    const auto answer =
        client().Post("/v1/jobs", {{"Prefer", "wait=60"}}, asked.dump(), "application/json");
    EXPECT_EQ(answer->status, 200) << answer->body;
    return api::Json::parse(answer->body).at("id");
  }
};

TEST_F(Repeats, OfALargeMeshLeaveOthersTheirResults) {
  start();
  const std::string others = submit("?stop.iterations=2");
  await_state(others, "succeeded");
  const std::string mesh = grid_glb(60);
  ASSERT_EQ(client().Put("/v1/meshes/" + sha256(mesh), mesh, "model/gltf-binary")->status, 201);
  std::vector<std::string> ids = {repeat(mesh)};
  const double once = stored_bytes();
  for (int k = 0; k < 10; ++k) ids.push_back(repeat(mesh));
  EXPECT_EQ(job(ids.back()).at("attempt"), 0) << "answered from the store";
  EXPECT_EQ(stored_bytes(), once);
  config_.disk.max_bytes = static_cast<std::int64_t>(once) * 2;
  restart();
  EXPECT_EQ(stored_bytes(), once);
  for (int k = 0; k < 10; ++k) ids.push_back(repeat(mesh));
  EXPECT_EQ(stored_bytes(), once);
  EXPECT_EQ(get(others, "result")->status, 200);
  for (std::size_t k = 0; k + 1 < ids.size(); ++k)
    ASSERT_EQ(client().Delete("/v1/jobs/" + ids[k])->status, 204);
  EXPECT_EQ(stored_bytes(), once) << "the last one has them";
  EXPECT_EQ(get(ids.back(), "result")->status, 200);
  client().Delete("/v1/jobs/" + ids.back());
  EXPECT_LT(stored_bytes(), once);
}

TEST_F(Repeats, HaveTheNotesOfTheirOwnOptions) {
  start();
  const auto answer = [&](const std::string& query) {
    const auto sent =
        client().Post("/v1/jobs?" + query, {{"Prefer", "wait=60"}}, grid_obj(3), "model/obj");
    const api::Json job = api::Json::parse(sent->body);
    const api::Json report = api::Json::parse(get(job.at("id"), "report")->body);
    std::string unused;
    for (const api::Json& note : report.at("notes"))
      if (note.at("code") == "option_unused") unused += note.at("text").get<std::string>();
    return std::pair(job.at("attempt").get<int>(), unused);
  };
  const std::string lambda = "The option lambda has no effect with the method arap.";
  EXPECT_EQ(answer("lambda=3"), std::pair(1, lambda));
  EXPECT_EQ(answer(""), std::pair(1, std::string()));
  EXPECT_EQ(answer("lambda=4"), std::pair(0, lambda)) << "the same answer and notes: stored";
  EXPECT_EQ(answer("resolution=1024"), std::pair(0, std::string()));
}

}  // namespace
}  // namespace unwrapd::server::uploads
