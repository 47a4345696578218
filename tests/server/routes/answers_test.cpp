// What every answer has and none says, whatever was sent.
#include <gmock/gmock.h>

#include "tests/server/raw_client.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::routes {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Answers : public RunningServer {
 protected:
  std::string exchange(const std::string& bytes) {
    const RawClient raw(service_->port());
    raw.send(bytes);
    return raw.finish();
  }
};

TEST_F(Answers, EveryAnswerIsWhatItsTypeSaysAndKeptByNobodyUnasked) {
  start();
  for (const char* path : {"/", "/v1/limits", "/v1/jobs", "/v1/nothing", "/openapi.yaml"}) {
    const auto answer = client().Get(path);
    EXPECT_EQ(answer->get_header_value("X-Content-Type-Options"), "nosniff") << path;
    EXPECT_THAT(answer->get_header_value("Cache-Control"), ContainsRegex("no-store|no-cache"));
    EXPECT_EQ(answer->get_header_value_count("Cache-Control"), 1U) << path;
  }
  EXPECT_THAT(exchange("nonsense\r\n\r\n"), HasSubstr("nosniff"));
}

TEST_F(Answers, WhatIsNoTextIsAnsweredAsAMistake) {
  start();
  const auto sent = [&](const std::string& query, const std::string& fields,
                        const std::string& body) {
    return exchange("POST /v1/jobs" + query + " HTTP/1.1\r\nHost: x\r\n" + fields +
                    "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  };
  const std::string mesh = grid_obj(2);
  for (const char* query : {"?materials=%ff", "?materials=a%ff,b", "?primitives=%c3%28", "?%ff=1",
                            "?method=%ed%a0%80", "?lambda=%c0%80"})
    EXPECT_THAT(sent(query, "Content-Type: model/obj\r\n", mesh), StartsWith("HTTP/1.1 400"))
        << query;
  const std::string form = "Content-Type: multipart/form-data; boundary=b\r\n";
  const std::string part = "--b\r\nContent-Disposition: form-data; name=";
  EXPECT_THAT(sent("", "Content-Type: model/obj; x=\xff\r\n", mesh), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(sent("", form, part + "\"buffer\"; filename=\"\xff\"\r\n\r\nx\r\n--b--"),
              StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(sent("", form, part + "\"options\"\r\n\r\n{\"a\xff\":1}\r\n--b--"),
              StartsWith("HTTP/1.1 4"));
  EXPECT_THAT(sent("", "Content-Type: model/obj\r\nIdempotency-Key:\r\n", mesh),
              StartsWith("HTTP/1.1 4"))
      << "an empty name is none";
}

TEST_F(Answers, EveryParameterOfAQueryIsReadAsItStands) {
  start();
  const auto pointer = [&](const std::string& query) {
    const std::string mesh = grid_obj(2);
    const std::string answer =
        exchange("POST /v1/jobs?" + query + " HTTP/1.1\r\nHost: x\r\nContent-Type: model/obj\r\n" +
                 "Content-Length: " + std::to_string(mesh.size()) + "\r\n\r\n" + mesh);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 422")) << query;
    const std::size_t body = answer.find("\r\n\r\n") + 4;
    return api::Json::parse(answer.substr(body, answer.rfind('}') + 1 - body)).value("pointer", "");
  };
  for (const char* nameless : {"=", "=x", "method=asap&=", "=method", "&=asap&", "==method"})
    EXPECT_EQ(pointer(nameless), "/") << nameless;
  EXPECT_EQ(pointer("a"), "/a");
  EXPECT_EQ(pointer("a/b~c"), "/a~1b~0c");
  EXPECT_EQ(pointer("m%00=x"), std::string("/m\0", 3));
  EXPECT_EQ(pointer("+a%20=x"), "/ a ");
  EXPECT_EQ(pointer("method"), "/method") << "it has no value";
  EXPECT_EQ(pointer("method=asap&method=asap"), "/method");
  EXPECT_EQ(pointer("method=asap&%6dethod=arap"), "/method");
  EXPECT_EQ(pointer("method=asap=abf"), "/method");
}

TEST_F(Answers, AParameterWithoutTextAndSignsInItsValueAreTaken) {
  start();
  for (const char* query : {"?", "?&", "?&&method=asap&", "?method=as%61p"})
    EXPECT_EQ(client().Post("/v1/jobs" + std::string(query), grid_obj(2), "model/obj")->status, 202)
        << query;
  const auto job = client().Post("/v1/jobs?materials=a=b?,c%2Bd%3D", grid_obj(2), "model/obj");
  ASSERT_EQ(job->status, 202) << job->body;
  EXPECT_EQ(api::Json::parse(job->body).at("options").at("materials"), (api::Json{"a=b?", "c+d="}));
  expect_problem(client().Get("/v1/jobs?a/b=1"), 422, "invalid_option");
  EXPECT_EQ(api::Json::parse(client().Get("/v1/jobs?a/b=1")->body).at("pointer"), "/a~1b");
}

TEST_F(Answers, AnErrorSaysNoMoreThanItMust) {
  start();
  const std::string name(5000, 'n');
  const auto answer = client().Post("/v1/jobs?" + name + "=1", grid_obj(2), "model/obj");
  expect_problem(answer, 422, "invalid_option");
  EXPECT_LT(answer->body.size(), 1500U);
  EXPECT_THAT(api::Json::parse(answer->body).at("pointer").get<std::string>(), HasSubstr("nnn..."));
  const std::string umlauts = "{\"" + std::string(1, 'x') + [] {
    std::string text;
    for (int k = 0; k < 2000; ++k) text += "\u00e4";
    return text;
  }() + "\":1}";
  const std::string body = "--b\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n" +
                           umlauts + "\r\n--b\r\nContent-Disposition: form-data; name=\"mesh\"" +
                           "\r\n\r\n" + grid_obj(2) + "\r\n--b--";
  const auto cut = client().Post("/v1/jobs", body, "multipart/form-data; boundary=b");
  EXPECT_EQ(cut->status, 422);
  EXPECT_LT(cut->body.size(), 1500U);
  EXPECT_THAT(cut->body, Not(HasSubstr("\uFFFD"))) << "no character is cut";
}

TEST_F(Answers, ThatNobodyCanHaveForWantOfAKeyAreToldOfAtTheStart) {
  config_.access.require_keys = true;
  const Log warning(LogLevel::warning);
  const auto told = [&] {
    testing::internal::CaptureStderr();
    service_ = std::make_unique<Service>(config_, warning);
    service_.reset();
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_THAT(told(), HasSubstr("unwrapd keys add --data " + dir_.path().string()));
  access::ApiKey key;
  key.name = "ci";
  key.scopes.read = true;
  access::KeyStore(dir_.path(), {}, config_.database).add(key);
  EXPECT_THAT(told(), Not(HasSubstr("keys add")));
}

}  // namespace
}  // namespace unwrapd::server::routes
