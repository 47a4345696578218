// A receiver of webhooks that answers as none should, on a real connection.
#include "server/webhooks/webhook_http.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>
#include <string_view>
#include <thread>

#include "server/http/listener.hpp"

namespace unwrapd::server {
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

/// What post_webhook() says of a receiver that answers with these bytes. The receiver takes the
/// whole request and waits for its end: a connection that is closed with bytes unread would be
/// reset, and the sender might lose the answer.
std::string said_of(const std::string& answer) {
  const Listener listener("127.0.0.1", 0);
  const std::jthread receiver([&] {
    std::array<pollfd, 1> door = {pollfd{listener.socket(), POLLIN, 0}};
    if (::poll(door.data(), 1, 60'000) != 1) return;
    const int client = listener.accept()->socket;
    ::fcntl(client, F_SETFL, 0);
    read_until(client, "{}");
    ::send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
    ::shutdown(client, SHUT_WR);
    read_until(client, "");
    ::close(client);
  });
  WebhookCall call;
  call.url = {.is_https = false, .host = "receiver.example", .port = listener.port()};
  call.address = "127.0.0.1";
  call.body = "{}";
  return post_webhook(call, {});
}

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

}  // namespace
}  // namespace unwrapd::server
