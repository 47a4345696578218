// Jobs with a list of lambdas: one map for each, all of them to be had until the job is gone.
#include "tests/server/running_server.hpp"

#include <gmock/gmock.h>

#include <set>
#include <vector>

namespace unwrapd::server::routes {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kCurve = "?preset=chart&method=hybrid&lambda=1,0.01,0.1";

class Curve : public RunningServer {
 protected:
  std::string succeeded(const std::string& query) {
    const std::string id = submit(query);
    await_state(id, "succeeded");
    return id;
  }
  std::string body(const std::string& id, const std::string& what,
                   const httplib::Headers& headers = {}) {
    const auto answer = get(id, what, headers);
    EXPECT_EQ(answer->status, 200) << what << ": " << answer->body;
    return answer->body;
  }
};

TEST_F(Curve, HasTheMapOfEveryLambdaAsIfItHadBeenAskedForAlone) {
  start();
  const std::string id = succeeded(kCurve);
  std::set<std::string> seen;
  for (const std::string& lambda : std::vector<std::string>{"1", "0.01", "0.1"}) {
    const std::string alone = succeeded("?preset=chart&method=hybrid&lambda=" + lambda);
    const std::string own = body(id, "result?lambda=" + lambda);
    EXPECT_EQ(own, body(alone, "result")) << lambda;
    EXPECT_EQ(body(id, "layout.svg?lambda=" + lambda), body(alone, "layout.svg")) << lambda;
    seen.insert(own);
  }
  EXPECT_EQ(seen.size(), 3U);
}

TEST_F(Curve, AnswersWithItsFirstLambdaWhenNoneIsNamed) {
  start();
  const std::string id = succeeded(kCurve);
  for (const char* what : {"result", "report", "layout.svg"})
    EXPECT_EQ(body(id, what), body(id, std::string(what) + "?lambda=1")) << what;
  EXPECT_NE(body(id, "result"), body(id, "result?lambda=0.01"));
}

TEST_F(Curve, IsInEveryReport) {
  start();
  const std::string id = succeeded(kCurve);
  for (const std::string& lambda : std::vector<std::string>{"1", "0.01", "0.1"}) {
    const api::Json report = api::Json::parse(body(id, "report?lambda=" + lambda));
    ASSERT_EQ(report.at("curve").size(), 3U);
    for (const api::Json& point : report.at("curve")) {
      if (point.at("lambda") != std::stod(lambda)) continue;
      EXPECT_EQ(point.at("distortion"), report.at("distortion"));
    }
  }
  EXPECT_EQ(api::Json::parse(body(id, "report")).at("curve").at(1).at("lambda"), 0.01);
}

TEST_F(Curve, NumbersAreTheSameHoweverTheyAreWritten) {
  start();
  const std::string id = succeeded(kCurve);
  EXPECT_EQ(body(id, "result?lambda=1e-1"), body(id, "result?lambda=0.10"));
}

TEST_F(Curve, RefusesALambdaThatItHasNot) {
  start();
  const std::string id = succeeded(kCurve);
  for (const char* lambda : {"0.2", "", "x", "0.1x", "nan", "0.100000000000001"}) {
    for (const char* what : {"result", "report", "layout.svg", "layout.png", "preview.png"}) {
      const auto answer = get(id, std::string(what) + "?lambda=" + lambda);
      expect_problem(answer, 422, "invalid_option");
      EXPECT_THAT(answer->body, HasSubstr("[1.0,0.01,0.1]"));
      EXPECT_THAT(answer->body, HasSubstr("\"pointer\":\"/lambda\""));
    }
  }
  expect_problem(get(id, "result?lambda=1&lambda=0.1"), 422, "invalid_option");
  expect_problem(get(id, "report?colour=area"), 422, "invalid_option");
}

TEST_F(Curve, OfOneLambdaIsNamedTooButNotOfAMethodWithoutLambda) {
  start();
  EXPECT_EQ(get(succeeded("?method=hybrid&lambda=2"), "result?lambda=2")->status, 200);
  expect_problem(get(succeeded("?method=asap"), "result?lambda=0.1"), 422, "invalid_option");
  const std::string ignored = succeeded("?method=arap&lambda=1,2");
  EXPECT_EQ(job(ignored).at("options").at("lambda"), nullptr);
  EXPECT_TRUE(api::Json::parse(body(ignored, "report")).at("curve").empty());
}

TEST_F(Curve, HasEveryFormatAndTagForEveryLambda) {
  start();
  const std::string id = succeeded(kCurve);
  std::set<std::string> tags;
  for (const char* type : {"model/gltf-binary", "application/json", "model/obj"}) {
    for (const char* lambda : {"1", "0.01", "0.1"}) {
      const auto answer = get(id, "result?lambda=" + std::string(lambda), {{"Accept", type}});
      EXPECT_EQ(answer->get_header_value("Content-Type"), type);
      tags.insert(answer->get_header_value("ETag"));
    }
  }
  EXPECT_EQ(tags.size(), 9U);
  const httplib::Headers json = {{"Accept", "application/json"}};
  const api::Json result = api::Json::parse(body(id, "result?lambda=0.01", json));
  EXPECT_EQ(result.at("report"), api::Json::parse(body(id, "report?lambda=0.01")));
}

TEST_F(Curve, IsThereAfterARestartAndGoneWithItsJob) {
  start();
  const std::string id = succeeded(kCurve);
  const std::string before = body(id, "result?lambda=0.1");
  restart();
  EXPECT_EQ(body(id, "result?lambda=0.1"), before);
  EXPECT_THAT(body(id, "result?lambda=0.1", {{"Accept", "model/gltf-binary"}}), StartsWith("glTF"));
  EXPECT_EQ(client().Delete("/v1/jobs/" + id)->status, 204);
  expect_problem(get(id, "result?lambda=0.1"), 404, "not_found");
}

TEST_F(Curve, ExpiresAsAWhole) {
  config_.keep_seconds = 2;
  start();
  const std::string id = succeeded(kCurve);
  await([&] { return get(id, "result?lambda=0.1")->status == 410; });
  expect_problem(get(id, "report?lambda=0.01"), 410, "result_expired");
}

/// The data of a story's iteration events.
std::vector<api::Json> iterations(const std::string& story) {
  std::vector<api::Json> found;
  const std::string head = "event: iteration\ndata: ";
  for (std::size_t at = story.find(head); at != std::string::npos; at = story.find(head, at + 1)) {
    const std::size_t from = at + head.size();
    found.push_back(api::Json::parse(story.substr(from, story.find('\n', from) - from)));
  }
  return found;
}

TEST_F(Curve, EventsSayTheLambdaAndTheFractionNeverGoesBack) {
  start();
  double fraction = 0;
  std::vector<double> lambdas;
  for (const api::Json& data : iterations(body(succeeded(kCurve), "events"))) {
    EXPECT_GE(data.at("fraction"), fraction);
    fraction = data.at("fraction");
    const double lambda = data.at("lambda");
    if (lambdas.empty() || lambdas.back() != lambda) lambdas.push_back(lambda);
  }
  EXPECT_EQ(lambdas, (std::vector<double>{1, 0.01, 0.1}));
  for (const api::Json& data : iterations(body(succeeded("?method=hybrid&lambda=1"), "events")))
    EXPECT_FALSE(data.contains("lambda"));
}

TEST_F(Curve, OfTheOneCallIsAnsweredWithItsFirstLambda) {
  start();
  const auto answer = client().Post("/v1/unwrap" + kCurve, grid_obj(4), "model/obj");
  ASSERT_EQ(answer->status, 200) << answer->body;
  EXPECT_EQ(client().Get(answer->get_header_value("Location") + "/result?lambda=1")->body,
            answer->body);
}

}  // namespace
}  // namespace unwrapd::server::routes
