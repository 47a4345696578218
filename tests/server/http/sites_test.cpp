// What a browser may do at a server without keys: by names that others have resolve to it, and from
// the pages of other sites.
#include "server/http/sites.hpp"

#include <gmock/gmock.h>

#include "tests/server/raw_client.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::http {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::optional<ErrorCode> site_refusal(const Sites& sites, const std::string& method,
                                      const std::string& host, const std::string& origin = "") {
  Request request;
  request.method = method;
  request.host = host;
  if (!origin.empty()) request.headers.emplace("Origin", origin);
  const std::optional<Error> error = sites.refusal(request);
  return error ? std::optional(error->code()) : std::nullopt;
}

TEST(Sites, AnswersToAddressesLocalhostAndTheNamesGiven) {
  const Cors cors({});
  const Sites sites({"uv.example", "*.lab.example"}, cors);
  for (const char* host :
       {"", "127.0.0.1", "127.0.0.1:8080", "10.1.2.3:1", "[::1]", "[::1]:8080", "[fe80::1]:1",
        "localhost", "LocalHost:8080", "uv.example", "UV.example:443", "a.lab.example:1"})
    EXPECT_EQ(site_refusal(sites, "GET", host), std::nullopt) << host;
  for (const char* host :
       {"evil.example", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example",
        "127.1", "0x7f000001", "2130706433", "::1", "[::1", "[evil.example]", "a.uv.example",
        "lab.example", "xlab.example", "127.0.0.1,evil.example", ":8080"})
    EXPECT_EQ(site_refusal(sites, "GET", host), ErrorCode::forbidden) << host;
  EXPECT_EQ(site_refusal(Sites({"*"}, cors), "GET", "evil.example"), std::nullopt);
}

TEST(Sites, TakesWhatChangesSomethingFromItsOwnPagesAndThoseAllowed) {
  const Cors cors({"https://good.example"});
  const Sites sites({"uv.example"}, cors);
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH"}) {
    for (const char* origin :
         {"", "http://uv.example:8080", "https://UV.example:8080", "https://good.example"})
      EXPECT_EQ(site_refusal(sites, method, "uv.example:8080", origin), std::nullopt) << origin;
    for (const char* origin :
         {"null", "https://evil.example", "http://uv.example", "http://uv.example:80801",
          "http://evil.example/uv.example:8080", "uv.example:8080", "https://good.example.evil"})
      EXPECT_EQ(site_refusal(sites, method, "uv.example:8080", origin), ErrorCode::forbidden)
          << origin;
  }
  for (const char* method : {"GET", "HEAD", "OPTIONS"})
    EXPECT_EQ(site_refusal(sites, method, "localhost", "https://evil.example"), std::nullopt);
}

class SitesOfAServer : public RunningServer {
 protected:
  std::string exchange(const std::string& head, const std::string& body = "") {
    const RawClient raw(service_->port());
    raw.send(head + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
    return raw.finish();
  }
};

TEST_F(SitesOfAServer, WithoutKeysNoPageReadsByARebornNameOrSendsFromElsewhere) {
  start();
  const std::string rebound = "GET /v1/jobs HTTP/1.1\r\nHost: rebind.example:8080\r\n";
  EXPECT_THAT(exchange(rebound), AllOf(StartsWith("HTTP/1.1 403"), HasSubstr("--allowed-hosts")));
  EXPECT_THAT(exchange("GET http://rebind.example/v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\n"),
              StartsWith("HTTP/1.1 403"));
  const std::string sent = "POST /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\n";
  EXPECT_THAT(exchange(sent + "Origin: https://evil.example\r\n", grid_obj(2)),
              AllOf(StartsWith("HTTP/1.1 403"), HasSubstr("--cors-origins")));
  EXPECT_THAT(exchange(sent + "Origin: http://127.0.0.1\r\n", grid_obj(2)),
              StartsWith("HTTP/1.1 202"));
}

TEST_F(SitesOfAServer, NoPageReadsTheAdminPortByARebornName) {
  config_.admin = http::Address{"127.0.0.1", 0};
  start();
  httplib::Client admin("127.0.0.1", *service_->admin_port());
  EXPECT_EQ(admin.Get("/metrics")->status, 200);
  EXPECT_EQ(admin.Get("/metrics", {{"Host", "rebind.example"}})->status, 403);
}

TEST_F(SitesOfAServer, WhereKeysAreAskedForNamesAndOriginsAreFree) {
  config_.access.require_keys = true;
  start();
  EXPECT_THAT(exchange("GET /v1/limits HTTP/1.1\r\nHost: any.example\r\n"),
              StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(exchange("POST /v1/jobs HTTP/1.1\r\nHost: any.example\r\nOrigin: https://y\r\n"),
              StartsWith("HTTP/1.1 401"));
}

}  // namespace
}  // namespace unwrapd::server::http
