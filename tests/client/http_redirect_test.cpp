// Redirects of downloads: where they go, and who gets the API key.
#include "client/http_redirect.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "client/http.hpp"
#include "tests/client/expect_failure.hpp"
#include "tests/client/fake_server.hpp"

namespace unwrapd::client {
namespace {

ServerUrl with_key(const std::string& address) {
  ServerUrl server = parse_server_url(address);
  server.key = "secret";
  return server;
}

TEST(HttpRedirect, GoesToAddressesOfAllForms) {
  const ServerUrl from = with_key("https://a:1/proxy");
  const auto to = [&](const char* location) {
    const Destination at = redirected(from, location);
    return at.server.origin + " " + at.server.prefix + at.path + " " + at.server.key;
  };
  EXPECT_EQ(to("http://b:2/c?d=%2F&e=1#f"), "http://b:2 /c?d=%2F&e=1 ");
  EXPECT_EQ(to("https://a:1/c"), "https://a:1 /c secret");
  EXPECT_EQ(to("/c?d"), "https://a:1 /c?d secret");
  EXPECT_EQ(to("//b/c"), "https://b /c ");
  EXPECT_EQ(to("http://a:1/c"), "http://a:1 /c ") << "without TLS it is another origin";
  EXPECT_EQ(to("https://a:12/c"), "https://a:12 /c ");
  EXPECT_EQ(to("https://b?d"), "https://b /?d ");
  for (const char* location : {"", "c", "ftp://b/c", "https:///c", "https://u@b/c", "c?d=http://b"})
    expect_failure(ExitCode::unreachable, [&] { redirected(from, location); });
}

TEST(HttpRedirect, GivesTheKeyToNoOtherOrigin) {
  FakeServer server, bucket;
  std::vector<std::string> seen;
  bucket.routes().Get("/o", [&](const httplib::Request& request, httplib::Response& response) {
    seen.push_back(request.get_header_value("Authorization") + request.get_param_value("s") +
                   request.get_header_value("Accept"));
    response.set_content("bytes", "model/obj");
  });
  std::string key;
  server.routes().Get("/r", [&](const httplib::Request& request, httplib::Response& response) {
    key = request.get_header_value("Authorization");
    response.set_redirect(bucket.address() + "/o?s=a%2Fb%2C%20c", 307);
  });
  server.start();
  bucket.start();
  std::string body;
  const auto take = [&](std::string_view bytes) { body += bytes; };
  const Http http(with_key(server.address()), {});
  EXPECT_EQ(http.get("/r", {{"Accept", "model/obj"}}, take).status, 200);
  EXPECT_EQ(body, "bytes");
  EXPECT_EQ(key, "Bearer secret");
  EXPECT_THAT(seen, testing::ElementsAre("a/b, cmodel/obj"));
}

TEST(HttpRedirect, EndsAfterAFew) {
  FakeServer server;
  int calls = 0;
  server.routes().Get("/r", [&](const httplib::Request&, httplib::Response& response) {
    ++calls;
    response.set_redirect("/r", 307);
  });
  server.start();
  const Http http(parse_server_url(server.address()), {});
  expect_failure(ExitCode::unreachable, [&] { static_cast<void>(http.get("/r")); });
  EXPECT_EQ(calls, 6);
}

}  // namespace
}  // namespace unwrapd::client
