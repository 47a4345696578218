// The client against a TLS server whose answers no server writes.
#include "client/http.hpp"
#include "tests/client/expect_failure.hpp"
#include "tests/client/tls_server.hpp"

namespace unwrapd::client {
namespace {

Reply get_from(const std::string& answer) {
  const TlsServer server(answer);
  return Http(parse_server_url(server.address()), {}).get("/v1/limits", {}, {});
}

void expect_refused(const std::string& answer) {
  try {
    get_from(answer);
    ADD_FAILURE() << "accepted: " << answer.substr(0, 60);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ExitCode::unreachable) << failure.what();
  }
}

TEST(Https, CarriesUsualAnswersAndLongBodies) {
  const std::string body(3'000'000, 'x');
  const Reply reply =
      get_from("HTTP/1.1 200 OK\r\nETag: \"a\"\r\nContent-Length: 3000000\r\n\r\n" + body);
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.header("etag"), "\"a\"");
  EXPECT_TRUE(reply.body == body);
}

TEST(Https, CarriesUploads) {
  const TemporaryFolder folder;
  const Upload upload = raw_upload(folder.write("a.obj", std::string(1'000'000, '#')));
  const TlsServer server("HTTP/1.1 202 Accepted\r\nContent-Length: 2\r\n\r\n{}");
  const Http http(parse_server_url(server.address()), {});
  EXPECT_EQ(http.post("/v1/jobs", upload, {}).status, 202);
}

TEST(Https, OutlivesHeadsWithoutEnd) {
  expect_refused("HTTP/1.1 200 " + std::string(300'000, 'x') + "\r\n\r\n");
  expect_refused("HTTP/1.1 200 OK\r\nX: " + std::string(300'000, 'y') + "\r\n\r\n");
  std::string many = "HTTP/1.1 200 OK\r\n", interim;
  for (int k = 0; k < 20'000; ++k) many += "X: y\r\n", interim += "HTTP/1.1 100 Continue\r\n\r\n";
  expect_refused(many + "\r\n");
  expect_refused(interim);
}

TEST(Https, TrustsNoCertificateThatNothingVouchesFor) {
  const TlsServer server("HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n");
  ::unsetenv("SSL_CERT_FILE");
  const Http http(parse_server_url(server.address()), {});
  EXPECT_THROW(http.get("/v1/limits", {}, {}), Failure);
}

}  // namespace
}  // namespace unwrapd::client
