// The front of the HTTP edge by itself: who waits, who is turned away, who is
// believed, TLS.
#include "tests/server/http_server_fixture.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <fstream>
#include <future>
#include <memory>
#include <thread>

namespace unwrapd::server::http {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Addresses, ASetHoldsAddressesAndRangesOfBothKinds) {
  const AddressSet set({"10.1.0.0/16", "192.168.1.7", "fd00::/9", "::1"});
  for (const char* in : {"10.1.255.3", "192.168.1.7", "fd7f::5", "::1", "::ffff:10.1.2.3"})
    EXPECT_TRUE(set.contains(in)) << in;
  for (const char* out : {"10.2.0.0", "192.168.1.8", "fd80::", "::2", "", "x", "10.1.1"})
    EXPECT_FALSE(set.contains(out)) << out;
  for (const char* wrong : {"10.0.0.0/33", "10.0.0/8", "::/129", "10.0.0.0/", "a", "1.2.3.4/8x",
                            "::ffff:10.0.0.0/8", "::ffff:0:0/95"})
    EXPECT_THROW(AddressSet({wrong}), Error) << wrong;
}

TEST(Addresses, ForwardedAddressesCountAsFarAsTheChainOfTrustedProxiesReaches) {
  const AddressSet proxies({"10.0.0.0/8"});
  EXPECT_EQ(client_behind("7.7.7.7", "1.1.1.1", proxies), "7.7.7.7");
  EXPECT_EQ(client_behind("10.0.0.1", "1.1.1.1", proxies), "1.1.1.1");
  EXPECT_EQ(client_behind("10.0.0.1", "1.1.1.1, 2.2.2.2", proxies), "2.2.2.2");
  EXPECT_EQ(client_behind("10.0.0.1", "1.1.1.1 ,10.9.9.9", proxies), "1.1.1.1");
  EXPECT_EQ(client_behind("10.0.0.1", "", proxies), "10.0.0.1");
  EXPECT_EQ(client_behind("10.0.0.1", "3.3.3.3, nonsense", proxies), "10.0.0.1");
  EXPECT_EQ(client_behind("10.0.0.1", "10.0.0.2", proxies), "10.0.0.2");
  EXPECT_EQ(client_behind("10.0.0.1", "1.1.1.1:1234", proxies), "1.1.1.1");
  EXPECT_EQ(client_behind("10.0.0.1", "2001:db8::1, 10.0.0.2:80", proxies), "2001:db8::1");
  EXPECT_EQ(client_behind("10.0.0.1", "[2001:db8::1]", proxies), "2001:db8::1");
  EXPECT_EQ(client_behind("10.0.0.1", "[2001:db8::1]:443", proxies), "2001:db8::1");
  EXPECT_EQ(client_behind("10.0.0.1", "[2001:db8::1", proxies), "10.0.0.1");
}

TEST(Addresses, OfIPv6AreCountedByTheirNetwork) {
  EXPECT_EQ(network_of("fd00::1:0:0:0:1"), network_of("fd00::1:ffff:0:0:2"));
  EXPECT_NE(network_of("fd00::1:0:0:0:1"), network_of("fd00::2"));  // another /64
  EXPECT_NE(network_of("1.1.1.1"), network_of("1.1.1.2"));
}

void allow_many_files() {
  rlimit files{};
  ::getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &files);
}

TEST_F(HttpServerTest, AThousandIdleAndTwoHundredSlowClientsTakeNoThreadFromOthers) {
  allow_many_files();
  config_.max_requests = 1;
  config_.idle_connections.idle = std::chrono::minutes(5);
  config_.idle_connections.head = std::chrono::minutes(5);
  start();
  std::vector<std::unique_ptr<RawClient>> waiting;
  for (int i = 0; i < 1200; ++i) {
    waiting.push_back(connect());
    if (i % 6 == 0) waiting.back()->send("GET / HTTP/1.1\r\nHost: x\r\nX-Slow: ");
  }
  await([&] { return server_->parked() == 1200; });
  EXPECT_THAT(get(), StartsWith("HTTP/1.1 200"));
  for (int i = 0; i < 1200; i += 6) waiting[static_cast<std::size_t>(i)]->send("done\r\n\r\n");
  for (int i = 0; i < 1200; i += 6)
    EXPECT_THAT(waiting[static_cast<std::size_t>(i)]->finish(), StartsWith("HTTP/1.1 200"));
}

TEST_F(HttpServerTest, AHeadThatDripsIsRefusedWhenItsTimeIsOver) {
  config_.idle_connections.head = milliseconds(150);
  start();
  const auto slow = connect();
  std::jthread drip([&](const std::stop_token& stop) {
    slow->send("GET / HTTP/1.1\r\nHost: x\r\nX: ");
    for (; !stop.stop_requested(); std::this_thread::sleep_for(milliseconds(10))) slow->send("x");
  });
  EXPECT_THAT(slow->read_to_end(), AllOf(StartsWith("HTTP/1.1 408"), HasSubstr("request_timeout")));
  await([&] { return refused("request_timeout") == 1U; });  // counted when the answer is out
}

TEST_F(HttpServerTest, WhoIsIdleTooLongIsClosedWithoutAWord) {
  config_.idle_connections.idle = milliseconds(50);
  start();
  EXPECT_EQ(connect()->read_to_end(), "");
}

TEST_F(HttpServerTest, KeepAliveSaysForHowLongAClientMayBeIdle) {
  config_.idle_connections.idle = std::chrono::milliseconds(2500);
  start();
  const auto client = connect();
  client->send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(client->read_until("\r\n\r\n"), testing::HasSubstr("\r\nKeep-Alive: timeout=2\r\n"));
  client->send("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(client->read_to_end(), testing::Not(testing::HasSubstr("Keep-Alive")));
}

TEST_F(HttpServerTest, OneIdleClientTooManyDrivesOutTheLongest) {
  config_.idle_connections.max_idle = 2;
  start();
  const auto first = connect();
  await([&] { return server_->parked() == 1; });
  const auto second = connect();
  await([&] { return server_->parked() == 2; });
  const auto third = connect();
  EXPECT_EQ(first->read_to_end(), "");
  third->send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(third->finish(), StartsWith("HTTP/1.1 200"));
}

TEST_F(HttpServerTest, OneConnectionTooManyIsTurnedAwayAndTold) {
  config_.max_connections = 2;
  start();
  auto first = connect();
  const auto second = connect();
  await([&] { return server_->open() == 2; });
  EXPECT_THAT(connect()->read_to_end(), AllOf(StartsWith("HTTP/1.1 429"), HasSubstr("rate_limited"),
                                              HasSubstr("Retry-After")));
  first.reset();
  await([&] { return server_->open() == 1; });
  EXPECT_THAT(get(), StartsWith("HTTP/1.1 200"));
}

TEST_F(HttpServerTest, AClientThatWaitsBetweenRequestsHasNoThread) {
  config_.max_requests = 1;
  start();
  httplib::Client kept("127.0.0.1", server_->port());
  kept.set_keep_alive(true);
  EXPECT_EQ(kept.Get("/")->status, 200);
  EXPECT_THAT(get(), StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(kept.Get("/")->status, 200);
  await([&] { return server_->parked() == 1; });
}

TEST_F(HttpServerTest, OnlyTrustedProxiesAreBelieved) {
  start();
  const httplib::Headers reservation = {{"X-Forwarded-For", "9.9.9.9"}};
  EXPECT_EQ(httplib::Client("127.0.0.1", server_->port()).Get("/", reservation)->body,
            "\"127.0.0.1\"");
  stop();
  proxies_ = AddressSet({"127.0.0.0/8"});
  start();
  EXPECT_EQ(httplib::Client("127.0.0.1", server_->port()).Get("/", reservation)->body,
            "\"9.9.9.9\"");
}

TEST_F(HttpServerTest, AnUploadThatDoesNotEndDoesNotHoldUpTheEnd) {
  config_.last_answers = milliseconds(50);
  std::promise<void> reading;
  answer_ = [&](const Request& request) {
    reading.set_value();
    request.body->read([](std::string_view) {});
    return json_response(200, "{}");
  };
  start();
  const auto client = connect();
  client->send("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 1000\r\n\r\nabc");
  reading.get_future().wait();
  stop();
  EXPECT_FALSE(serving_.joinable());
}

TEST_F(HttpServerTest, TlsCarriesRequestsBodiesAndTheDeadlines) {
  const TempDir dir;
  config_.tls_certificate = dir.path() / "cert.pem";
  config_.tls_key = dir.path() / "key.pem";
  config_.idle_connections.idle = milliseconds(500);
  write_certificate(config_.tls_certificate, config_.tls_key);
  answer_ = [](const Request& request) {
    std::string body;
    if (request.body) request.body->read([&](std::string_view bytes) { body += bytes; });
    return json_response(200, body);
  };
  start();
  const std::string large(700'000, 'x');
  httplib::SSLClient client("127.0.0.1", server_->port());
  client.enable_server_certificate_verification(false);
  client.set_keep_alive(true);
  for (int k = 0; k < 2; ++k) {
    const auto answer = client.Post("/", large, "text/plain");
    ASSERT_TRUE(answer) << httplib::to_string(answer.error());
    EXPECT_EQ(answer->body, large);
  }
  const auto plain = connect();
  plain->send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(plain->read_to_end(), testing::Not(HasSubstr("200")));
  EXPECT_EQ(connect()->read_to_end(), "");  // never begins its handshake
}

TEST_F(HttpServerTest, ACertificateThatCannotBeUsedIsNamed) {
  const TempDir dir;
  config_.tls_certificate = dir.path() / "cert.pem";
  config_.tls_key = dir.path() / "key.pem";
  write_certificate(config_.tls_certificate, config_.tls_key);
  std::ofstream(config_.tls_key) << "nonsense";
  try {
    start();
    ADD_FAILURE() << "taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("key.pem"), HasSubstr("--tls-key")));
  }
}

}  // namespace
}  // namespace unwrapd::server::http
