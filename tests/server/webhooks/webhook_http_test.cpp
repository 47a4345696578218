// A receiver of webhooks that answers as none should, on a real connection.
#include "server/webhooks/webhook_http.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "server/http/listener.hpp"
#include "server/webhooks/webhooks.hpp"
#include "tests/server/http_server_fixture.hpp"

namespace unwrapd::server::webhooks {
namespace {

/// Reads until the sender's bytes end so, or there are no more.
void read_until(int sender, std::string_view end) {
  std::string all;
  std::array<char, 4096> some{};
  while (end.empty() || !all.ends_with(end)) {
    const ssize_t count = ::recv(sender, some.data(), some.size(), 0);
    if (count <= 0) return;
    all.append(some.data(), static_cast<std::size_t>(count));
  }
}

/// A receiver of one call, on a thread of its own.
class Receiver {
 public:
  /// serve: what it does with the socket, which is closed afterwards.
  explicit Receiver(std::function<void(int socket)> serve)
      : thread_([this, serve = std::move(serve)] {
          std::array<pollfd, 1> door = {pollfd{listener_.socket(), POLLIN, 0}};
          if (::poll(door.data(), 1, 60'000) != 1) return;
          const int client = listener_.accept()->socket;
          ::fcntl(client, F_SETFL, 0);
          serve(client);
          ::close(client);
        }) {}

  [[nodiscard]] WebhookCall call() const {
    WebhookCall call;
    call.url = {.is_https = false, .host = "receiver.example", .port = listener_.port()};
    call.address = "127.0.0.1";
    call.body = "{}";
    return call;
  }

 private:
  const http::Listener listener_{"127.0.0.1", 0};
  std::jthread thread_;
};

/// What post_webhook() says of a receiver that answers with these bytes. The receiver takes the
/// whole request and waits for its end: a connection that is closed with bytes unread would be
/// reset, and the sender might lose the answer.
WebhookAnswer answered(const std::string& answer) {
  const Receiver receiver([&](int client) {
    read_until(client, "{}");
    ::send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
    ::shutdown(client, SHUT_WR);
    read_until(client, "");
  });
  return post_webhook(receiver.call(), {});
}

std::string said_of(const std::string& answer) { return answered(answer).failure; }

TEST(WebhookHttp, TakesAnAnswerWithLongFields) {
  const std::string field = "X: " + std::string(4000, 'x') + "\r\n";
  EXPECT_EQ(said_of("HTTP/1.1 200 OK\r\n" + field + "Content-Length: 0\r\n\r\n"), "");
  EXPECT_EQ(said_of("HTTP/1.1 404 No\r\nContent-Length: 0\r\n\r\n"), "status 404");
}

TEST(WebhookHttp, OutlivesAStatusLineWithoutEnd) {
  const std::string head = "HTTP/1.1 200 ";
  for (const std::size_t length : {1000U, 15'000U, 60'000U, 1'000'000U}) {
    const std::string end = "\r\nContent-Length: 0\r\n\r\n";
    EXPECT_NE(said_of(head + std::string(length, 'a') + end), "") << length;
    EXPECT_NE(said_of("HTTP/1.1 100 Continue\r\n\r\n" + head + std::string(length, 'a') + end), "");
    EXPECT_NE(said_of(std::string(length, '\n') + head + std::string(length, 'a') + end), "");
  }
}

TEST(WebhookHttp, WaitsForTheAnswerThatComesAfterHints) {
  const std::string hints = "HTTP/1.1 103 Early Hints\r\nLink: </a>\r\n\r\n";
  EXPECT_EQ(said_of(hints + "HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n"), "");
}

TEST(WebhookHttp, TakesNoAnswerWhoseHeadHasNoEnd) {
  EXPECT_NE(said_of("HTTP/1.1 200 OK\r\nContent-Length: 0\r\n"), "");
  EXPECT_NE(said_of("HTTP/1.1 103 Early Hints\r\n\r\n"), "");
  std::string fields;
  for (int i = 0; i < 1000; ++i) fields += "X: " + std::string(20, 'x') + "\r\n";
  EXPECT_NE(said_of("HTTP/1.1 200 OK\r\n" + fields + "\r\n"), "");
}

TEST(WebhookHttp, FollowsNoRedirect) {
  const std::string place = "Location: http://127.0.0.1:1/\r\nContent-Length: 0\r\n\r\n";
  EXPECT_EQ(said_of("HTTP/1.1 307 Go\r\n" + place), "status 307");
}

TEST(WebhookHttp, TellsWhenTheReceiverWantsToBeCalledAgain) {
  using std::chrono::seconds;
  const std::string busy = "HTTP/1.1 503 Busy\r\nContent-Length: 0\r\n";
  EXPECT_EQ(answered(busy + "\r\n").retry_after, seconds(0));
  EXPECT_EQ(answered(busy + "Retry-After: 120\r\n\r\n").retry_after, seconds(120));
  const std::string late = "Retry-After: Fri, 31 Dec 2100 23:59:59 GMT\r\n\r\n";
  EXPECT_GT(answered(busy + late).retry_after, seconds(86'400));
  EXPECT_GE(answered(busy + "Retry-After: -5\r\n\r\n").retry_after, seconds(0));
  EXPECT_FALSE(answered(busy + "\r\n").is_gone);
  EXPECT_TRUE(answered("HTTP/1.1 410 Gone\r\nContent-Length: 0\r\n\r\n").is_gone);
}

TEST(WebhookHttp, UsesNoProxyOfTheEnvironment) {
  for (const char* name : {"http_proxy", "all_proxy"}) ::setenv(name, "http://127.0.0.1:1", 1);
  EXPECT_EQ(said_of("HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n"), "");
  for (const char* name : {"http_proxy", "all_proxy"}) ::unsetenv(name);
}

TEST(WebhookHttp, ConnectsToTheCheckedAddressWhateverTheHost) {
  for (const char* host : {"receiver.example", "8.8.8.8", "127.0.0.2", "127.2", "0x7f000002",
                           "2130706434", "2606:4700:4700::1111", "localhost"}) {
    std::string request;
    {
      const Receiver receiver([&](int client) {
        std::array<char, 4096> some{};
        const ssize_t count = ::recv(client, some.data(), some.size(), 0);
        request.assign(some.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
      });
      WebhookCall call = receiver.call();
      call.url.host = host;
      call.url.target = "/a/../b?c=[{\\}]";
      EXPECT_NE(post_webhook(call, {}).failure, "");
    }
    EXPECT_TRUE(request.starts_with("POST /a/../b?c=[{\\}] HTTP/1.1\r\n")) << host << request;
  }
}

TEST(WebhookHttp, EndsWhenItIsToldTo) {
  std::stop_source stop;
  const Receiver receiver([&](int client) {
    read_until(client, "{}");
    stop.request_stop();
    read_until(client, "");  // until the caller hangs up
  });
  EXPECT_NE(post_webhook(receiver.call(), stop.get_token()).failure, "");
}

TEST(WebhookHttp, OutlivesAReceiverThatHangsUpInTheHandshake) {
  const Receiver receiver([](int) {});
  WebhookCall call = receiver.call();
  call.url.is_https = true;
  EXPECT_NE(post_webhook(call, {}).failure, "");
}

/// What post_webhook() says of a receiver in TLS that is called by this name.
std::string said_in_tls(const std::string& host, const std::string& certificate,
                        const std::string& key) {
  httplib::SSLServer receiver(certificate.c_str(), key.c_str());
  receiver.Post("/", [](const httplib::Request&, httplib::Response&) {});
  WebhookCall call{.url = {.host = host, .port = receiver.bind_to_any_port("127.0.0.1")},
                   .address = "127.0.0.1",
                   .headers = {},
                   .body = "{}"};
  const std::jthread serving([&] { receiver.listen_after_bind(); });
  while (!receiver.is_running()) std::this_thread::yield();
  std::string failure = post_webhook(call, {}).failure;
  receiver.stop();
  return failure;
}

TEST(WebhookHttp, TrustsCertificatesThatTheSystemTrustsAndOnlyForTheirHost) {
  const TempDir files;
  const std::string certificate = files.path() / "cert.pem", key = files.path() / "key.pem";
  write_certificate(certificate, key);
  EXPECT_NE(said_in_tls("receiver.example", certificate, key), "");
  ::setenv("SSL_CERT_FILE", certificate.c_str(), 1);
  EXPECT_EQ(said_in_tls("receiver.example", certificate, key), "");
  EXPECT_NE(said_in_tls("other.example", certificate, key), "");
  ::unsetenv("SSL_CERT_FILE");
}

TEST(Webhook, IsCalledAgainAfterDoubledPausesOrWhenTheReceiverAskedFor) {
  using std::chrono::seconds;
  constexpr std::int64_t kHour = 3'600'000;
  EXPECT_EQ(webhook_pause_ms(5, 0, {}), 5'000);
  EXPECT_EQ(webhook_pause_ms(5, 3, {}), 40'000);
  EXPECT_EQ(webhook_pause_ms(3600, 9, {}), kHour);
  EXPECT_EQ(webhook_pause_ms(5, 0, {.failure = "", .retry_after = seconds(120)}), 120'000);
  EXPECT_EQ(webhook_pause_ms(5, 9, {.failure = "", .retry_after = seconds(120)}), 2'560'000);
  EXPECT_EQ(webhook_pause_ms(5, 0, {.failure = "", .retry_after = seconds::max()}), kHour);
}

}  // namespace
}  // namespace unwrapd::server::webhooks
