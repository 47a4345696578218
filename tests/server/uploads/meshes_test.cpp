// Meshes that are stored once and made many jobs of.
#include <gmock/gmock.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "api/options.hpp"
#include "server/base/identity.hpp"
#include "server/work/rendering.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::uploads {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class StoredMeshes : public RunningServer {
 protected:
  static std::string path_of(const std::string& bytes) { return "/v1/meshes/" + sha256(bytes); }

  httplib::Result put(const std::string& bytes, const std::string& type = "model/obj") {
    return client().Put(path_of(bytes), bytes, type.c_str());
  }
  httplib::Result look_at(const std::string& bytes) { return client().Get(path_of(bytes)); }

  /// Asks for a job by JSON.
  httplib::Result post(const std::string& json, const std::string& query = "") {
    return client().Post("/v1/jobs" + query, {{"Prefer", "wait=60"}}, json, "application/json");
  }
  httplib::Result post_mesh(const std::string& bytes, const api::Json& options) {
    return post(api::Json{{"mesh", sha256(bytes)}, {"options", options}}.dump());
  }

  /// Folders below DIR/blobs that begin so: of jobs, "j_", or meshes, "m_".
  std::vector<fs::path> folders(const std::string& prefix) {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(dir_.path() / "blobs"))
      if (entry.path().filename().string().starts_with(prefix)) found.push_back(entry.path());
    return found;
  }
};

TEST_F(StoredMeshes, AreWhatTheirDigestSays) {
  start();
  const std::string mesh = grid_obj(4);
  const auto first = put(mesh);
  ASSERT_EQ(first->status, 201) << first->body;
  EXPECT_EQ(first->get_header_value("Location"), path_of(mesh));
  const api::Json told = api::Json::parse(first->body);
  EXPECT_EQ(told.at("sha256"), sha256(mesh));
  EXPECT_EQ(told.at("bytes"), mesh.size());
  EXPECT_EQ(told.at("media_type"), "model/obj");
  EXPECT_EQ(told.at("links").at("self"), path_of(mesh));
  EXPECT_EQ(put(mesh, "application/octet-stream")->status, 200);
  const api::Json again = api::Json::parse(look_at(mesh)->body);
  EXPECT_EQ(again.at("created"), told.at("created"));
  EXPECT_EQ(again.at("media_type"), "application/octet-stream");
  EXPECT_EQ(folders("m_").size(), 1U);
}

TEST_F(StoredMeshes, AreAnalysed) {
  start();
  const std::string mesh = grid_obj(4);
  put(mesh);
  const api::Json analysis = api::Json::parse(look_at(mesh)->body).at("analysis");
  EXPECT_EQ(analysis.at("format"), "obj");
  EXPECT_EQ(analysis.at("faces"), 32);
  EXPECT_EQ(analysis.at("vertices"), 25);
  EXPECT_EQ(analysis.at("components"), 1);
  EXPECT_EQ(analysis.at("boundaries"), 1);
  EXPECT_EQ(analysis.at("genus"), 0);
  EXPECT_EQ(analysis.at("repairs"), api::Json::array());
  const std::string twice =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 5\nv 1 0 5\nv 0 1 5\n"
      "f 1 2 3\nf 1 2 3\nf 4 5 6\n";
  put(twice);
  const api::Json other = api::Json::parse(look_at(twice)->body).at("analysis");
  EXPECT_EQ(other.at("components"), 2);
  EXPECT_EQ(other.at("boundaries"), 2);
  EXPECT_EQ(other.at("repairs").at(0).at("kind"), "duplicate_faces_set_aside");
}

TEST_F(StoredMeshes, OnesThatCannotBeUnwrappedSayWhy) {
  config_.limits.max_faces = 100;
  start();
  const auto problem_of = [&](const std::string& mesh) {
    EXPECT_EQ(put(mesh)->status, 201);
    const auto answer = look_at(mesh);
    EXPECT_EQ(answer->status, 200) << answer->body;
    return api::Json::parse(answer->body).at("problem").at("code").get<std::string>();
  };
  EXPECT_EQ(problem_of("no mesh"), "unknown_format");
  EXPECT_EQ(problem_of("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "zero_area");
  EXPECT_EQ(problem_of("v 0 0 0\nf 1 2 3\n"), "malformed_obj");
  EXPECT_EQ(problem_of(grid_obj(20)), "too_many_faces");
}

TEST_F(StoredMeshes, AreAnalysedOnceForAllWhoAsk) {
  std::atomic<int> made = 0;
  work::WorkerFunctions functions;
  functions.draw = [&](const work::Rendering& what, const work::RenderingInput& input,
                       const auto& limits) {
    ++made;
    return work::render(what, input, limits);
  };
  service_ = std::make_unique<Service>(config_, log_, functions);
  const std::string mesh = grid_obj(20);
  put(mesh);
  std::vector<std::jthread> askers;
  for (int k = 0; k < 6; ++k)
    askers.emplace_back([&] { EXPECT_THAT(look_at(mesh)->body, HasSubstr("\"faces\":800")); });
  askers.clear();
  EXPECT_EQ(made, 1);
}

TEST_F(StoredMeshes, WhatDoesNotHaveTheDigestIsRefusedAndLeavesNothing) {
  start();
  const std::string mesh = grid_obj(4);
  const auto refused = client().Put(path_of(mesh), mesh + "v 0 0 0\n", "model/obj");
  expect_problem(refused, 400, "digest_mismatch");
  EXPECT_THAT(refused->body, HasSubstr(sha256(mesh + "v 0 0 0\n")));
  expect_problem(client().Put(path_of(mesh), "", "model/obj"), 415, "unknown_format");
  EXPECT_TRUE(fs::is_empty(dir_.path() / "incoming"));
  EXPECT_TRUE(fs::is_empty(dir_.path() / "blobs"));
  expect_problem(look_at(mesh), 404, "mesh_not_found");
  expect_problem(client().Put("/v1/meshes/AB", mesh, "model/obj"), 404, "not_found");
  expect_problem(put(mesh, "text/plain"), 415, "unsupported_media_type");
  expect_problem(put(mesh, "application/json"), 415, "unsupported_media_type");
}

TEST_F(StoredMeshes, AreMadeJobsOf) {
  start();
  const std::string mesh = grid_glb(6);
  put(mesh, "model/gltf-binary");
  const auto answer = post_mesh(mesh, {{"method", "hybrid"}, {"lambda", 0.5}});
  ASSERT_EQ(answer->status, 200) << answer->body;
  const api::Json job = api::Json::parse(answer->body);
  EXPECT_EQ(job.at("state"), "succeeded");
  EXPECT_EQ(job.at("options").at("lambda"), 0.5);
  const std::string id = job.at("id");
  const auto sent = client().Post("/v1/unwrap?method=hybrid&lambda=0.5",
                                  {{"Cache-Control", "no-cache"}}, mesh, "model/gltf-binary");
  EXPECT_EQ(get(id, "result")->body, sent->body);
  EXPECT_EQ(api::Json::parse(get(id, "report")->body).at("input").at("sha256"), sha256(mesh));
  const auto by_query = post(api::Json{{"mesh", sha256(mesh)}}.dump(), "?method=asap");
  EXPECT_EQ(api::Json::parse(by_query->body).at("options").at("method"), "asap");
}

TEST_F(StoredMeshes, AskTheSameQuestionAsWhenTheyAreSent) {
  start();
  const std::string mesh = grid_obj(4);
  const std::string id = submit();
  await_state(id, "succeeded");
  put(mesh);
  const api::Json job = api::Json::parse(post_mesh(mesh, {{"preset", "chart"}})->body);
  EXPECT_EQ(job.at("attempt"), 0) << "answered from the store";
  EXPECT_EQ(get(job.at("id"), "result")->body, get(id, "result")->body);
}

TEST_F(StoredMeshes, ThatAreNotThereAreNamedByAPointer) {
  start();
  const auto missing = post_mesh(grid_obj(4), api::Json::object());
  expect_problem(missing, 404, "mesh_not_found");
  EXPECT_EQ(api::Json::parse(missing->body).at("pointer"), "/mesh");
  const std::string digest = sha256("x");
  const auto pointer = [&](const std::string& json, const std::string& query = "") {
    const auto answer = post(json, query);
    expect_problem(answer, 422, "invalid_option");
    return api::Json::parse(answer->body).value("pointer", "");
  };
  EXPECT_EQ(pointer("{}"), "/mesh");
  EXPECT_EQ(pointer(R"({"mesh": 7})"), "/mesh");
  EXPECT_EQ(pointer(R"({"mesh": "../../etc/passwd"})"), "/mesh");
  EXPECT_EQ(pointer(R"({"mesh": ")" + digest + R"(", "options": []})"), "/options");
  EXPECT_EQ(pointer(R"({"mesh": ")" + digest + R"(", "option": {}})"), "/option");
  EXPECT_EQ(pointer(R"({"mesh": ")" + digest + R"(", "mesh": ")" + digest + R"("})"), "/mesh");
  expect_problem(post("[]"), 400, "malformed_request");
  expect_problem(post(R"({"mesh": )"), 400, "malformed_request");
  put(grid_obj(4));
  const std::string known = sha256(grid_obj(4));
  EXPECT_EQ(pointer(R"({"mesh": ")" + known + R"(", "options": {"method": "none"}})"),
            "/options/method");
  EXPECT_EQ(pointer(R"({"mesh": ")" + known + R"(", "options": {}})", "?method=asap"), "/method");
  EXPECT_TRUE(fs::is_empty(dir_.path() / "incoming"));
}

TEST_F(StoredMeshes, APointerLeadsToTheOptionInTheDocumentThatWasSent) {
  start();
  put(grid_obj(2));
  const auto pointer = [](const httplib::Result& answer) {
    expect_problem(answer, 422, "invalid_option");
    return api::Json::parse(answer->body).value("pointer", "none");
  };
  const auto leads_to = [](const api::Json& document, const std::string& place) {
    const api::Json::json_pointer at(place);
    return document.contains(at) ? document.at(at) : api::Json("nothing");
  };
  const api::Json bad = {{"a", 1}};
  const std::string bad_text = "[[" + std::string(200, '1') + "]]";  // too long even for a name
  for (const api::OptionRow& row : api::option_table()) {
    api::Json options;
    options[api::Json::json_pointer(api::option_pointer(row.name))] = bad;
    const api::Json named = {{"mesh", sha256(grid_obj(2))}, {"options", options}};
    EXPECT_EQ(leads_to(named, pointer(post(named.dump()))), bad) << row.name;
    const httplib::MultipartFormDataItems form = {
        {.name = "options", .content = options.dump(), .filename = "", .content_type = ""},
        {.name = "mesh", .content = grid_obj(2), .filename = "", .content_type = ""}};
    EXPECT_EQ(leads_to(options, pointer(client().Post("/v1/jobs", form))), bad) << row.name;
    const auto asked = client().Post("/v1/jobs?" + std::string(row.name) + "=" + bad_text,
                                     grid_obj(2), "model/obj");
    EXPECT_EQ(api::option_at(pointer(asked)), &row) << row.name;
  }
}

TEST_F(StoredMeshes, APointerIntoAnOptionLeadsThereToo) {
  start();
  put(grid_obj(2));
  const std::string digest = sha256(grid_obj(2));
  const auto pointer = [&](const std::string& options) {
    const auto answer = post(R"({"mesh": ")" + digest + R"(", "options": )" + options + "}");
    EXPECT_EQ(answer->status, 422) << answer->body;
    return api::Json::parse(answer->body).value("pointer", "none");
  };
  EXPECT_EQ(pointer(R"({"constraints": [{"vertex": 0, "uv": [0, "x"]}]})"),
            "/options/constraints/0/uv");
  EXPECT_EQ(pointer(R"({"stop": {"iteration": 1}})"), "/options/stop/iteration");
  EXPECT_EQ(pointer(R"({"a/b": 1})"), "/options/a~1b");
  EXPECT_EQ(pointer(R"({"": 1})"), "/options/");
  EXPECT_EQ(pointer(R"({"": 1, "": 2})"), "/options/");
  EXPECT_EQ(pointer(R"({"pins": "spectral", "pins": "spectral"})"), "/options/pins");
  EXPECT_EQ(pointer(R"({"resolution": 16, "padding": 5})"), "/options/padding");
  EXPECT_EQ(pointer("[]"), "/options");
}

TEST_F(StoredMeshes, ShareTheirBytesWithTheirJobsAndStayAsLongAsThey) {
  config_.keep_seconds = 2;
  start();
  const std::string mesh = grid_obj(120);
  put(mesh);
  const std::string endless =
      api::Json::parse(client()
                           .Post("/v1/jobs?stop.iterations=10000",
                                 api::Json{{"mesh", sha256(mesh)}}.dump(), "application/json")
                           ->body)
          .at("id");
  EXPECT_EQ(fs::hard_link_count(folders("m_").at(0) / "document"), 2U);
  const std::string lonely = grid_obj(5);
  put(lonely);
  await([&] { return look_at(lonely)->status == 404; });  // its time is over, and the other's
  EXPECT_EQ(look_at(mesh)->status, 200);
  client().Delete("/v1/jobs/" + endless);
  await([&] { return look_at(mesh)->status == 404; });
  await([&] { return folders("m_").empty(); });  // the row goes first
}

TEST_F(StoredMeshes, AreKeptOverARestart) {
  start();
  const std::string mesh = grid_obj(4);
  put(mesh);
  fs::create_directories(dir_.path() / "blobs" / ("m_" + std::string(32, '0')));  // of a crash
  restart();
  EXPECT_EQ(folders("m_").size(), 1U);
  EXPECT_EQ(api::Json::parse(post_mesh(mesh, api::Json::object())->body).at("state"), "succeeded");
}

TEST_F(StoredMeshes, OnesThatAreDamagedAreNoticedAndCanBeSentAgain) {
  start();
  const std::string mesh = grid_obj(4);
  put(mesh);
  const fs::path document = folders("m_").at(0) / "document";
  fs::permissions(document, fs::perms::owner_all);
  std::fstream(document, std::ios::in | std::ios::out).write("w", 1);
  const auto refused = post_mesh(mesh, api::Json::object());
  expect_problem(refused, 500, "storage_corrupt");
  EXPECT_EQ(api::Json::parse(refused->body).at("pointer"), "/mesh");
  EXPECT_EQ(put(mesh)->status, 201);
  EXPECT_EQ(api::Json::parse(post_mesh(mesh, api::Json::object())->body).at("state"), "succeeded");
  EXPECT_EQ(folders("m_").size(), 1U);
}

}  // namespace
}  // namespace unwrapd::server::uploads
