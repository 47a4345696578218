// The life of jobs, as their owners see it over HTTP.
#include "api/options.hpp"  // Eigen before httplib, whose headers define _res

#include "tests/server/running_server.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <set>
#include <thread>

namespace unwrapd::server::jobs {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Jobs : public RunningServer {};

TEST_F(Jobs, AnObjComesBackWithTextureCoordinates) {
  start();
  const std::string id = submit("?method=arap");
  await_state(id, "succeeded");
  const auto result = get(id, "result");
  EXPECT_EQ(result->status, 200);
  EXPECT_EQ(result->get_header_value("Content-Type"), "model/obj");
  EXPECT_THAT(result->body, HasSubstr("vt "));
  const auto report = get(id, "report");
  EXPECT_EQ(api::Json::parse(report->body).at("input").at("faces"), 32);
  const auto layout = get(id, "layout.svg");
  EXPECT_EQ(layout->get_header_value("Content-Type"), "image/svg+xml");
  EXPECT_THAT(layout->body, StartsWith("<svg"));
}

TEST_F(Jobs, AGlbComesBackAsAGlb) {
  start();
  const httplib::Headers wait = {{"Prefer", "wait=60"}};
  const auto answer = client().Post("/v1/jobs", wait, grid_glb(5), "model/gltf-binary");
  ASSERT_EQ(answer->status, 200) << answer->body;
  const api::Json job = api::Json::parse(answer->body);
  EXPECT_EQ(job.at("state"), "succeeded") << job;
  const auto result = client().Get(job.at("links").at("result").get<std::string>());
  EXPECT_THAT(result->body, StartsWith("glTF"));
  EXPECT_THAT(result->body, HasSubstr("TEXCOORD_0"));
}

TEST_F(Jobs, AFormBringsOptionsMeshAndBuffers) {
  start();
  const httplib::MultipartFormDataItems parts = {
      {"options", R"({"method": "asap", "output": "glb"})", "", "application/json"},
      {"mesh", grid_gltf(4), "grid.gltf", "model/gltf+json"},
      {"buffer", grid_buffer(4), "grid.bin", "application/octet-stream"}};
  const auto answer = client().Post("/v1/jobs", {{"Prefer", "wait=60"}}, parts);
  ASSERT_EQ(answer->status, 200) << answer->body;
  const api::Json job = api::Json::parse(answer->body);
  EXPECT_EQ(job.at("state"), "succeeded") << job;
  EXPECT_EQ(job.at("options").at("method"), "asap");
  EXPECT_GT(job.at("finished"), job.at("created"));
  EXPECT_GT(job.at("duration"), 0);
  EXPECT_THAT(get(job.at("id"), "result")->body, StartsWith("glTF"));
}

TEST_F(Jobs, AFormIsKnownHoweverItsTypeIsWritten) {
  start();
  const std::string body = "--q\r\nContent-Disposition: form-data; name=\"mesh\"\r\n\r\n" +
                           grid_obj(2) + "\r\n--q--\r\n";
  for (const char* type : {"Multipart/form-data; boundary=q", "multipart/form-data; Boundary=q",
                           "multipart/form-data; boundary=\"q\"; charset=utf-8"})
    EXPECT_EQ(client().Post("/v1/unwrap", body, type)->status, 200) << type;
}

TEST_F(Jobs, AFormWithoutItsMeshOrWithAnythingTwiceIsRefused) {
  start();
  const httplib::MultipartFormData mesh = {"mesh", grid_obj(2), "grid.obj", "model/obj"};
  const httplib::MultipartFormData buffer = {"buffer", "x", "a.bin", ""};
  const httplib::MultipartFormData options = {"options", "{}", "", ""};
  const httplib::MultipartFormData nameless = {"buffer", "x", "", ""};
  const httplib::MultipartFormData unknown = {"option", "x", "a.bin", ""};
  for (const httplib::MultipartFormDataItems& parts :
       std::vector<httplib::MultipartFormDataItems>{{options},
                                                    {mesh, mesh},
                                                    {mesh, buffer, buffer},
                                                    {mesh, options, options},
                                                    {mesh, nameless},
                                                    {mesh, unknown}})
    expect_problem(client().Post("/v1/jobs", parts), 400, "malformed_request");
  const httplib::MultipartFormDataItems both = {options, mesh};
  expect_problem(client().Post("/v1/jobs?method=arap", both), 422, "invalid_option");
}

TEST_F(Jobs, AFormMayBringEachOptionInAPartOfItsName) {
  start();
  using Parts = httplib::MultipartFormDataItems;
  const httplib::MultipartFormData mesh = {"file", grid_obj(4), "grid.obj", "model/obj"};
  const httplib::MultipartFormData method = {"method", "asap", "", ""};
  const Parts parts = {method, mesh, {"stop.iterations", "3", "", ""}};
  const auto answer = client().Post("/v1/jobs", {{"Prefer", "wait=60"}}, parts);
  ASSERT_EQ(answer->status, 200) << answer->body;
  EXPECT_EQ(api::Json::parse(answer->body).at("options").at("stop").at("iterations"), 3);
  for (const Parts& wrong : {Parts{mesh, {"metod", "arap", "", ""}},
                             Parts{mesh, {"method", "x", "", ""}}, Parts{mesh, method, method}})
    expect_problem(client().Post("/v1/jobs", wrong), 422, "invalid_option");
  expect_problem(client().Post("/v1/jobs", Parts{mesh, {"", "", "", ""}}), 400,
                 "malformed_request");
  expect_problem(client().Post("/v1/jobs?pins=spectral", parts), 422, "invalid_option");
  const Parts both = {mesh, method, {"options", "{}", "", ""}};
  expect_problem(client().Post("/v1/jobs", both), 400, "malformed_request");
  const Parts large = {{"materials", std::string(65'536, 'a'), "", ""}, mesh};
  expect_problem(client().Post("/v1/jobs", large), 413, "body_too_large");
}

TEST_F(Jobs, WaitingIsAnsweredEarlyWhenTheJobIsNotDone) {
  config_.limits.max_wait_seconds = 1;
  start();
  const auto answer = client().Post("/v1/jobs?stop.iterations=10000", {{"Prefer", "wait=100"}},
                                    grid_obj(120), "model/obj");
  EXPECT_EQ(answer->status, 202);
  EXPECT_EQ(answer->get_header_value("Preference-Applied"), "wait=1");
  EXPECT_THAT(answer->get_header_value("Location"), StartsWith("/v1/jobs/j_"));
}

TEST_F(Jobs, BadOptionsAreToldAtOnceWithTheirPlace) {
  start();
  for (const char* option : {"method=best", "lambda=-1", "lambda=nan", "stop.iterations=0",
                             "stop.iterations=1000000000", "iterations=10", "nonsense=1"}) {
    const auto answer = client().Post("/v1/jobs?" + std::string(option), grid_obj(2), "model/obj");
    expect_problem(answer, 422, "invalid_option");
    const std::string name = std::string(option).substr(0, std::string(option).find('='));
    EXPECT_EQ(api::Json::parse(answer->body).value("pointer", ""), api::option_pointer(name));
  }
}

TEST_F(Jobs, ConstraintsMayBeManyButNoMoreThanTheLimit) {
  config_.limits.max_constraints = 2000;
  start();
  std::string list = R"({"vertex":0,"uv":[0.5,0.5],"weight":1})";
  const auto send = [&] {
    const std::string text = R"({"constraints":[)" + list + "]}";
    return client().Post("/v1/jobs", httplib::MultipartFormDataItems{
                                         {"options", text, "", "application/json"},
                                         {"mesh", grid_obj(2), "grid.obj", "model/obj"}});
  };
  for (int k = 1; k < 2000; ++k) list += R"(,{"vertex":0,"uv":[0.5,0.5],"weight":1})";
  const auto most = send();
  EXPECT_EQ(most->status, 202) << most->body;
  list += R"(,{"vertex":0,"uv":[0.5,0.5],"weight":1})";
  const auto more = send();
  expect_problem(more, 422, "invalid_option");
  EXPECT_EQ(api::Json::parse(more->body).at("pointer"), "/constraints");
}

TEST_F(Jobs, AnAssetThatCannotBeReadFailsItsJobWithAProblem) {
  start();
  const auto answer = client().Post("/v1/jobs", {{"Prefer", "wait=60"}}, "glTF but not really",
                                    "model/gltf-binary");
  const api::Json job = api::Json::parse(answer->body);
  EXPECT_EQ(job.at("state"), "failed");
  EXPECT_EQ(job.at("problem").at("code"), "malformed_glb");
  EXPECT_EQ(job.at("problem").at("job"), job.at("id"));
  expect_problem(get(job.at("id"), "result"), 400, "malformed_glb");
}

TEST_F(Jobs, AGuaranteeThatCannotBeKeptFailsItsJobAndLeavesNothing) {
  start();
  const auto posted = [&](const std::string& guarantee) {  // a cell pinned as seen from behind
    const std::string options = R"({"guarantee": ")" + guarantee + R"(", "constraints": [
        {"vertex": 0, "uv": [0.8, 0.2]}, {"vertex": 1, "uv": [0.2, 0.2]},
        {"vertex": 5, "uv": [0.8, 0.8]}, {"vertex": 6, "uv": [0.2, 0.8]}]})";
    const httplib::MultipartFormDataItems parts = {{"options", options, "", "application/json"},
                                                   {"mesh", grid_obj(4), "grid.obj", "model/obj"}};
    return api::Json::parse(client().Post("/v1/jobs", {{"Prefer", "wait=60"}}, parts)->body);
  };
  for (const char* guarantee : {"flip_free", "bijective"}) {
    const api::Json job = posted(guarantee);
    ASSERT_EQ(job.at("state"), "failed") << job;
    EXPECT_EQ(job.at("problem").at("code"), "guarantee_failed");
    EXPECT_EQ(job.at("problem").at("status"), 422);
    EXPECT_EQ(job.at("problem").at("pointer"), "/guarantee");
    EXPECT_THAT(job.at("problem").at("detail"), HasSubstr("guarantee=none"));
    for (const char* what : {"result", "report", "layout.svg", "layout.png", "preview.png"})
      expect_problem(get(job.at("id"), what), 422, "guarantee_failed");
  }
  const api::Json job = posted("none");
  EXPECT_EQ(job.at("state"), "succeeded");
  const auto report = api::Json::parse(get(job.at("id"), "report")->body);
  EXPECT_GE(report.at("distortion").at("flipped"), 2);
}

TEST_F(Jobs, ARunningJobIsCancelledWithinAnIteration) {
  start();
  const std::string id = submit_endless();
  await_state(id, "running");
  expect_problem(get(id, "result"), 409, "job_unfinished");
  EXPECT_EQ(client().Delete("/v1/jobs/" + id)->status, 202);
  await_state(id, "cancelled");
  expect_problem(get(id, "result"), 409, "cancelled");
  EXPECT_EQ(client().Delete("/v1/jobs/" + id)->status, 204);
  expect_problem(client().Get("/v1/jobs/" + id), 404, "not_found");
}

TEST_F(Jobs, WhoComesBackWhenToldFindsThePlaceThatANewcomerDoesNotGet) {
  config_.workers = 1;
  config_.limits.max_queue = 2;
  start();
  const std::string running = submit_endless();
  await_state(running, "running");
  const std::string waiting = submit();
  submit();
  const auto send = [&](int size) {
    return client().Post("/v1/jobs", grid_obj(size), "model/obj");
  };
  const auto refused = send(2);
  const auto when = std::chrono::steady_clock::now();
  expect_problem(refused, 429, "queue_full");
  const std::chrono::seconds told(std::stoi(refused->get_header_value("Retry-After")));
  std::this_thread::sleep_until(when + told);
  client().Delete("/v1/jobs/" + waiting);
  const auto newcomer = send(3);
  const auto returned = send(2);
  client().Delete("/v1/jobs/" + running);
  if (std::chrono::steady_clock::now() > when + told + std::chrono::seconds(1))
    GTEST_SKIP() << "too slow a machine to come back in time";
  expect_problem(newcomer, 429, "queue_full");
  EXPECT_EQ(returned->status, 202);
}

TEST_F(Jobs, AWaitingJobIsCancelledAtOnceAndAFullQueueRefuses) {
  config_.workers = 1;
  config_.limits.max_queue = 1;
  start();
  const std::string running = submit_endless();
  await_state(running, "running");
  const std::string waiting = submit();
  const auto refused = client().Post("/v1/jobs", grid_obj(2), "model/obj");
  expect_problem(refused, 429, "queue_full");
  EXPECT_GE(std::stoi(refused->get_header_value("Retry-After")), 1);
  const auto cancelled = client().Delete("/v1/jobs/" + waiting);
  EXPECT_EQ(api::Json::parse(cancelled->body).at("state"), "cancelled");
  client().Delete("/v1/jobs/" + running);
  await_state(submit(), "succeeded");
  EXPECT_EQ(state(waiting), "cancelled");
}

TEST_F(Jobs, AJobThatTakesTooLongFails) {
  config_.limits.max_job_seconds = 1;
  start();
  const std::string id = submit_endless();
  await_state(id, "failed");
  EXPECT_EQ(job(id).at("problem").at("code"), "time_limit");
}

TEST_F(Jobs, AJobThatTakesTooLongIsToldToWhoWaitsForIt) {
  config_.limits.max_job_seconds = 1;
  start();
  expect_problem(client().Post("/v1/unwrap?stop.iterations=10000", grid_obj(120), "model/obj"), 422,
                 "time_limit");
}

TEST_F(Jobs, ManySendersAtOnceEachGetTheirOwnAnswer) {
  constexpr int kSenders = 8;
  constexpr int kJobsEach = 20;
  start();
  std::array<std::vector<std::string>, kSenders> ids;
  {
    std::vector<std::jthread> senders;
    for (int s = 0; s < kSenders; ++s) {
      senders.emplace_back([&, s] {
        for (int k = 0; k < kJobsEach; ++k)
          ids.at(static_cast<std::size_t>(s)).push_back(submit("", 2 + s));
      });
    }
  }
  std::set<std::string> all;
  for (int s = 0; s < kSenders; ++s) {
    for (const std::string& id : ids.at(static_cast<std::size_t>(s))) {
      await_state(id, "succeeded");
      const api::Json report = api::Json::parse(get(id, "report")->body);
      EXPECT_EQ(report.at("input").at("faces"), 2 * (2 + s) * (2 + s));
      all.insert(id);
    }
  }
  EXPECT_EQ(all.size(), kSenders * kJobsEach);
}

TEST_F(Jobs, TheSameMeshGivesTheSameBytesOnAnyNumberOfThreads) {
  std::set<std::string> results;
  for (const int threads : {1, 2, 3}) {
    config_.threads = threads;
    service_.reset();
    start();
    const std::string id = submit("?method=hybrid&lambda=0.2", 60);
    await_state(id, "succeeded");
    results.insert(get(id, "result")->body);
  }
  EXPECT_EQ(results.size(), 1U);
}

}  // namespace
}  // namespace unwrapd::server::jobs
