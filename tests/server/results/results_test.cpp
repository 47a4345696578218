// Results: formats, caching, ranges, expiry; and the synchronous call.
#include "tests/server/running_server.hpp"

#include <gmock/gmock.h>

namespace unwrapd::server::results {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Results : public RunningServer {
 protected:
  std::string succeeded() {
    const std::string id = submit();
    await_state(id, "succeeded");
    return id;
  }
};

TEST_F(Results, AcceptChoosesTheFormat) {
  start();
  const std::string id = succeeded();
  const std::string obj = get(id, "result")->body;
  EXPECT_THAT(get(id, "result", {{"Accept", "model/gltf-binary"}})->body, StartsWith("glTF"));
  const auto gltf = get(id, "result", {{"Accept", "model/gltf+json"}});
  EXPECT_EQ(gltf->get_header_value("Content-Type"), "model/gltf+json");
  EXPECT_EQ(api::Json::parse(gltf->body).at("asset").at("version"), "2.0");
  const auto json = get(id, "result", {{"Accept", "application/json"}});
  const api::Json result = api::Json::parse(json->body);
  EXPECT_EQ(result.at("report"), api::Json::parse(get(id, "report")->body));
  EXPECT_EQ(result.at("meshes").at(0).at("faces").size(), 3U * 32U);
  EXPECT_EQ(get(id, "result", {{"Accept", "model/obj"}})->body, obj);
  expect_problem(get(id, "result", {{"Accept", "image/png"}}), 406, "not_acceptable");
}

TEST_F(Results, AKnownTagSavesTheDownload) {
  start();
  const std::string id = succeeded();
  const std::string etag = get(id, "result")->get_header_value("ETag");
  EXPECT_EQ(etag.size(), 66U);
  const auto unchanged = get(id, "result", {{"If-None-Match", etag}});
  EXPECT_EQ(unchanged->status, 304);
  EXPECT_TRUE(unchanged->body.empty());
  EXPECT_EQ(get(id, "result", {{"If-None-Match", "\"other\""}})->status, 200);
  EXPECT_NE(get(id, "result", {{"Accept", "model/gltf-binary"}})->get_header_value("ETag"), etag);
}

TEST_F(Results, ARangeIsAPieceOfTheWhole) {
  start();
  const std::string id = succeeded();
  const std::string whole = get(id, "result")->body;
  const auto piece = get(id, "result", {{"Range", "bytes=5-14"}});
  EXPECT_EQ(piece->status, 206);
  EXPECT_EQ(piece->body, whole.substr(5, 10));
  EXPECT_EQ(piece->get_header_value("Content-Range"), "bytes 5-14/" + std::to_string(whole.size()));
  EXPECT_EQ(get(id, "result", {{"Range", "bytes=999999999-"}})->body, whole);
  EXPECT_EQ(get(id, "result", {{"Range", "bytes=0-3"}, {"If-Range", "\"other\""}})->body, whole);
  for (const char* range : {"bytes=5-2", "bytes=x", "items=0-5", "bytes"})
    EXPECT_EQ(get(id, "result", {{"Range", range}})->body, whole) << range;
  const auto posted = client().Post("/v1/jobs", {{"Range", "items=0-5"}}, grid_obj(2), "model/obj");
  EXPECT_EQ(posted->status, 202) << "it means nothing there";
}

TEST_F(Results, HeadTellsWhatGetWouldSend) {
  start();
  const std::string path = "/v1/jobs/" + succeeded() + "/result";
  const auto whole = client().Get(path);
  const auto head = client().Head(path);
  EXPECT_EQ(head->status, 200);
  EXPECT_TRUE(head->body.empty());
  EXPECT_EQ(head->get_header_value("Content-Length"), std::to_string(whole->body.size()));
  EXPECT_EQ(head->get_header_value("ETag"), whole->get_header_value("ETag"));
}

TEST_F(Results, AreThereAfterARestart) {
  start();
  const std::string id = succeeded();
  const std::string before = get(id, "result")->body;
  const std::string report = get(id, "report")->body;
  restart();
  EXPECT_EQ(get(id, "result")->body, before);
  EXPECT_EQ(get(id, "report")->body, report);
  EXPECT_THAT(get(id, "result", {{"Accept", "model/gltf-binary"}})->body, StartsWith("glTF"));
}

TEST_F(Results, ExpireAfterTheirTime) {
  config_.keep_seconds = 2;
  start();
  const std::string id = succeeded();
  await([&] { return get(id, "result")->status == 410; });
  expect_problem(get(id, "report"), 410, "result_expired");
  await([&] { return client().Get("/v1/jobs/" + id)->status == 404; });
}

TEST_F(Results, ASmallMeshIsUnwrappedInOneCall) {
  start();
  const auto answer =
      client().Post("/v1/unwrap?preset=chart&method=asap", grid_glb(4), "model/gltf-binary");
  ASSERT_EQ(answer->status, 200) << answer->body;
  EXPECT_THAT(answer->body, StartsWith("glTF"));
  const api::Json totals = api::Json::parse(answer->get_header_value("Unwrapd-Report"));
  EXPECT_EQ(totals.at("charts"), 1);
  EXPECT_EQ(client().Get(answer->get_header_value("Location"))->status, 200);
  const httplib::Headers accept = {{"Accept", "application/json"}};
  const auto json = client().Post("/v1/unwrap", accept, grid_obj(4), "model/obj");
  EXPECT_THAT(json->body, StartsWith("{\"report\""));
  const httplib::Headers known = {{"If-None-Match", answer->get_header_value("ETag")}};
  const auto again =
      client().Post("/v1/unwrap?preset=chart&method=asap", known, grid_glb(4), "model/gltf-binary");
  EXPECT_EQ(again->body, answer->body);
}

TEST_F(Results, TheOneCallRefusesWhatOnlyAJobMayBe) {
  config_.limits.max_sync_faces = 31;
  start();
  const auto answer = client().Post("/v1/unwrap", grid_obj(4), "model/obj");
  expect_problem(answer, 413, "too_many_faces");
  EXPECT_THAT(answer->body, HasSubstr("\"job\":\"j_"));
  await_state(submit("", 4), "succeeded");
}

}  // namespace
}  // namespace unwrapd::server::results
