// The HTTP edge, spoken to in raw bytes: framing, limits, and that no request
// harms the next.
#include "tests/server/running_server.hpp"

#include <gmock/gmock.h>

#include <array>
#include <random>

#include "tests/server/raw_client.hpp"

namespace unwrapd::server::http {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Edge : public RunningServer {
 protected:
  Edge() { config_.limits.max_body_bytes = 100'000; }

  std::string exchange(const std::string& bytes) {
    const RawClient raw(service_->port());
    raw.send(bytes);
    return raw.finish();
  }
  std::string post(const std::string& fields, const std::string& body) {
    return exchange("POST /v1/jobs HTTP/1.1\r\nHost: x\r\n" + fields + "\r\n" + body);
  }
};

std::string chunk(std::string_view bytes) {
  std::array<char, 16> size;
  std::snprintf(size.data(), size.size(), "%zx\r\n", bytes.size());
  return size.data() + std::string(bytes) + "\r\n";
}

TEST_F(Edge, AChunkedBodyIsTheSameHoweverItIsCut) {
  start();
  const std::string mesh = grid_obj(5);
  std::mt19937 random(3);
  for (const std::size_t longest : {1U, 7U, 5000U}) {
    std::string body;
    for (std::size_t at = 0; at < mesh.size();) {
      const std::size_t size = std::min(1 + random() % longest, mesh.size() - at);
      body += chunk(std::string_view(mesh).substr(at, size));
      at += size;
    }
    const std::string answer = post("Prefer: wait=60\r\nTransfer-Encoding: chunked\r\n",
                                    body + "0\r\nX-Trailer: y\r\n\r\n");
    ASSERT_THAT(answer, StartsWith("HTTP/1.1 200"));
    const std::size_t id = answer.find("/v1/jobs/") + 9;
    const auto report = get(answer.substr(id, 34), "report");
    EXPECT_EQ(api::Json::parse(report->body).at("input").at("bytes"), mesh.size());
  }
}

TEST_F(Edge, ABodyOverTheLimitIsRefusedHoweverItIsSent) {
  start();
  const std::string large = grid_obj(60);
  ASSERT_GT(large.size(), 100'000U);
  const std::string length = "Content-Length: " + std::to_string(large.size()) + "\r\n";
  EXPECT_THAT(post(length, large), AllOf(StartsWith("HTTP/1.1 413"), HasSubstr("body_too_large")));
  std::string chunks;
  for (std::size_t at = 0; at < large.size(); at += 1000)
    chunks += chunk(std::string_view(large).substr(at, 1000));
  EXPECT_THAT(post("Transfer-Encoding: chunked\r\n", chunks + "0\r\n\r\n"),
              AllOf(StartsWith("HTTP/1.1 413"), HasSubstr("body_too_large")));
  EXPECT_THAT(post("Transfer-Encoding: chunked\r\n", "fffffff0\r\nv 0 0 0\n"),
              StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(post("Content-Length: 99999999999\r\n", "v 0 0 0\n"), StartsWith("HTTP/1.1 413"));
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "incoming"));
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "blobs"));
}

TEST_F(Edge, WhoWaitsFor100GetsItWhenTheBodyIsWanted) {
  start();
  const std::string mesh = grid_obj(4);
  const auto head = [](const std::string& path, std::size_t length) {
    return "POST " + path + " HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nContent-Length: " +
           std::to_string(length) + "\r\n\r\n";
  };
  RawClient wanted(service_->port());
  wanted.send(head("/v1/jobs", mesh.size()));
  EXPECT_EQ(wanted.read_until("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
  wanted.send(mesh);
  EXPECT_THAT(wanted.finish(), StartsWith("HTTP/1.1 202"));
  EXPECT_THAT(exchange(head("/v1/jobs", mesh.size()) + mesh), StartsWith("HTTP/1.1 202"))
      << "a sender that did not wait";
  for (const auto& [path, length, status] :
       {std::tuple{"/v1/jobs", std::size_t{200'000}, "HTTP/1.1 413"},
        std::tuple{"/v1/jobs?method=none", mesh.size(), "HTTP/1.1 422"},
        std::tuple{"/v1/nothing", mesh.size(), "HTTP/1.1 404"}}) {
    RawClient refused(service_->port());
    refused.send(head(path, length));
    EXPECT_THAT(refused.read_until("\r\n\r\n"), AllOf(StartsWith(status), HasSubstr("close")));
  }
}

TEST_F(Edge, AbsoluteTargetsArePaths) {
  config_.allowed_hosts = {"*"};
  start();
  const std::string get = "GET http://other:81/v1/limits HTTP/1.1\r\nHost: x\r\n\r\n";
  const std::string post = "POST http://other/v1/jobs?method=asap HTTP/1.1\r\nHost: x\r\n";
  const std::string mesh = grid_obj(4);
  const std::string answers = exchange(
      get + post + "Content-Length: " + std::to_string(mesh.size()) + "\r\n\r\n" + mesh + get);
  const std::size_t first = answers.find("HTTP/1.1 200");
  const std::size_t second = answers.find("HTTP/1.1 202", first);
  EXPECT_NE(answers.find("HTTP/1.1 200", second), std::string::npos) << answers;
  EXPECT_THAT(exchange("GET http://u@other/v1/limits HTTP/1.1\r\nHost: x\r\n\r\n"),
              StartsWith("HTTP/1.1 400"));
}

TEST_F(Edge, BrokenChunksAreRefused) {
  start();
  for (const char* body :
       {"zz\r\nabc\r\n0\r\n\r\n", "-2\r\nabc\r\n0\r\n\r\n", "3\r\nabcdef\r\n0\r\n\r\n",
        "123456789\r\nabc", "\r\n\r\n", "0x3\r\nabc\r\n0\r\n\r\n"})
    EXPECT_THAT(post("Transfer-Encoding: chunked\r\n", body),
                AllOf(StartsWith("HTTP/1.1 4"), HasSubstr("application/problem+json")))
        << body;
  EXPECT_THAT(post("Transfer-Encoding: chunked\r\n", std::string(10'000, '1')),
              StartsWith("HTTP/1.1 400"));
}

TEST_F(Edge, ABodyThatEndsEarlyMakesNoJob) {
  start();
  EXPECT_THAT(post("Content-Length: 500\r\n", "v 0 0 0\n"), StartsWith("HTTP/1.1 408"));
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "blobs"));
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "incoming"));
}

TEST_F(Edge, RefusalsAreProblemsAndCloseTheConnection) {
  start();
  const std::array<std::pair<const char*, const char*>, 7> cases = {{
      {"\x16\x03\x01\r\n\r\n", "HTTP/1.1 400"},
      {"GET / HTTP/3.0\r\nHost: x\r\n\r\n", "HTTP/1.1 400"},
      {"GET /healthz HTTP/1.1\r\n\r\n", "HTTP/1.1 400"},
      {"POST /v1/jobs HTTP/1.1\r\nHost: x\r\n\r\n", "HTTP/1.1 411"},
      {"POST /v1/jobs HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\nContent-Length: "
       "2\r\n\r\nab",
       "HTTP/1.1 400"},
      {"POST /v1/jobs HTTP/1.1\r\nHost: x\r\nContent-Encoding: br\r\nContent-Length: "
       "1\r\n\r\na",
       "HTTP/1.1 415"},
      {"BREW /healthz HTTP/1.1\r\nHost: x\r\n\r\n", "HTTP/1.1 400"},
  }};
  for (const auto& [request, status] : cases) {
    const std::string answer =
        exchange(std::string(request) + "GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n");
    EXPECT_THAT(answer, AllOf(StartsWith(status), HasSubstr("application/problem+json")))
        << request;
  }
  EXPECT_THAT(exchange("GET / HTTP/1.1\r\nHost: x\r\nX: " + std::string(40'000, 'a')),
              StartsWith("HTTP/1.1 431"));
}

TEST_F(Edge, RefusalsOfWhatCanBeReadTellTheirTraceToThePageThatAsked) {
  config_.cors_origins = {"*"};
  start();
  const std::string trace = "00-0af7651916cd43dd8448eb211c80319c-";
  const std::string sent = "Origin: https://x\r\ntraceparent: " + trace + "b7ad6b7169203331-01\r\n";
  for (const auto& [fields, status] :
       {std::pair{"", "HTTP/1.1 411"},
        {"Content-Encoding: br\r\nContent-Length: 1\r\n", "HTTP/1.1 415"},
        {"Content-Length: 1\r\nContent-Type: a/b\r\nContent-Type: c/d\r\n", "HTTP/1.1 400"}})
    EXPECT_THAT(post(sent + fields, "x"),
                AllOf(StartsWith(status), HasSubstr("application/problem+json"),
                      HasSubstr("traceparent: " + trace), HasSubstr("Connection: close"),
                      HasSubstr("Access-Control-Allow-Origin: https://x")));
}

TEST_F(Edge, FieldsOfOneNameAreOneList) {  // RFC 9110, 5.3
  start();
  const std::string job = submit();
  await_state(job, "succeeded");
  const auto get_result = [&](const std::string& fields) {
    return exchange("GET /v1/jobs/" + job + "/result HTTP/1.1\r\nHost: x\r\n" + fields + "\r\n");
  };
  const std::string etag = get(job, "result")->get_header_value("ETag");
  EXPECT_THAT(get_result("Accept: text/html\r\nAccept: model/obj\r\n"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(get_result("If-None-Match: \"x\"\r\nIf-None-Match: " + etag + "\r\n"),
              StartsWith("HTTP/1.1 304"));
  const std::string length = "Content-Length: " + std::to_string(grid_obj(3).size()) + "\r\n";
  EXPECT_THAT(post("Prefer: respond-async\r\nPrefer: wait=60\r\n" + length, grid_obj(3)),
              StartsWith("HTTP/1.1 200"));
}

TEST_F(Edge, ARefusedBodyIsNeverReadAsTheNextRequest) {
  start();
  const std::string hidden = "GET /v1/limits HTTP/1.1\r\nHost: x\r\n\r\n";
  const std::string fields =
      "Content-Type: text/html\r\nContent-Length: " + std::to_string(hidden.size()) + "\r\n";
  const std::string answer = post(fields, hidden);
  EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.1 415"), HasSubstr("Connection: close"),
                            Not(HasSubstr("max_body_bytes"))));
}

TEST_F(Edge, OneConnectionCarriesManyRequests) {
  start();
  const std::string get_health = "GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n";
  const std::string mesh = grid_obj(2);
  const std::string post_job =
      "POST /v1/jobs HTTP/1.1\r\nHost: x\r\nContent-Length: " + std::to_string(mesh.size()) +
      "\r\n\r\n" + mesh;
  const std::string answers = exchange(get_health + post_job + get_health);
  const std::size_t first = answers.find("HTTP/1.1 200");
  const std::size_t second = answers.find("HTTP/1.1 202", first + 1);
  EXPECT_NE(answers.find("HTTP/1.1 200", second + 1), std::string::npos) << answers;
}

TEST_F(Edge, KnownPathsTellTheirMethodsAndUnknownOnesAreNotFound) {
  start();
  for (const char* path : {"/v1", "/v1/jobs/", "/v1/jobs/j_1", "/v1/jobs/{id}", "/v1/JOBS/x",
                           "/v1/jobs/../../etc/passwd", "/healthz/", "//healthz"})
    expect_problem(client().Get(path), 404, "not_found");
  const std::array<std::pair<const char*, const char*>, 3> known = {
      {{"/v1/jobs", "POST, GET, HEAD, OPTIONS"},
       {"/healthz", "GET, HEAD, OPTIONS"},
       {"/v1/unwrap", "POST, OPTIONS"}}};
  for (const auto& [path, allowed] : known) {
    const auto answer = client().Delete(path);
    expect_problem(answer, 405, "method_not_allowed");
    EXPECT_EQ(answer->get_header_value("Allow"), allowed);
    const auto options = client().Options(path);  // which is allowed, as it says
    EXPECT_EQ(options->status, 204);
    EXPECT_EQ(options->get_header_value("Allow"), allowed);
  }
  expect_problem(client().Put("/v1/methods", "x", "text/plain"), 405, "method_not_allowed");
  expect_problem(client().Options("/v1/nothing"), 404, "not_found");
}

TEST_F(Edge, TheServerTellsOfItself) {
  start();
  for (const char* path : {"/v1/methods", "/v1/limits", "/healthz", "/readyz"}) {
    const auto answer = client().Get(path);
    EXPECT_EQ(answer->status, 200);
    EXPECT_TRUE(api::Json::parse(answer->body).is_object()) << path;
    EXPECT_EQ(client().Head(path)->status, 200);
  }
  EXPECT_EQ(api::Json::parse(client().Get("/v1/limits")->body).at("max_body_bytes"), 100'000);
  EXPECT_THAT(client().Get("/openapi.yaml")->body, StartsWith("openapi: 3.1"));
}

TEST_F(Edge, HostileFormsAreAnswered) {
  start();
  const std::string type = "Content-Type: multipart/form-data; boundary=b\r\n";
  const std::string part = "--b\r\nContent-Disposition: form-data; name=\"mesh\"";
  for (const std::string& body :
       {std::string(), std::string("--b--\r\n"), part, part + "\r\n\r\nv 0 0 0",
        "--b\r\nContent-Disposition: form-data; name=\"" + std::string(8000, 'a') +
            "\"\r\n\r\nx\r\n",
        "--b\r\n" + std::string(90'000, 'h'), part + "\r\n\r\n" + std::string(50'000, '\n'),
        std::string(90'000, '-')}) {
    const std::string length = "Content-Length: " + std::to_string(body.size()) + "\r\n";
    EXPECT_THAT(post(type + length, body), StartsWith("HTTP/1.1 4"));
  }
  EXPECT_THAT(post("Content-Type: multipart/form-data\r\nContent-Length: 1\r\n", "x"),
              StartsWith("HTTP/1.1 4"));
  EXPECT_EQ(client().Get("/healthz")->status, 200);
}

TEST_F(Edge, RandomBytesNeverEndTheServer) {
  start();
  std::mt19937 random(11);
  const std::string good =
      "POST /v1/jobs?method=arap HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: "
      "chunked\r\n\r\n" +
      chunk(grid_obj(2)) + "0\r\n\r\n";
  for (int k = 0; k < 200; ++k) {
    std::string bytes = good;
    for (int changes = 0; changes < 4; ++changes)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    exchange(bytes);
  }
  EXPECT_EQ(client().Get("/healthz")->status, 200);
}

}  // namespace
}  // namespace unwrapd::server::http
