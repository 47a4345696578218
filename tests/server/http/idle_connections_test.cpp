// The parking lot by itself: handshakes, which are made elsewhere.
#include "api/options.hpp"  // Eigen before httplib, whose headers define _res

#include "server/http/idle_connections.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <future>
#include <memory>
#include <string>
#include <thread>

#include "server/http/tls.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::http {
namespace {

using std::chrono::milliseconds;

const std::string kHead = "GET / HTTP/1.1\r\nHost: x\r\n\r\n";

/// Its handshake takes one byte at a time, and ends with '!'; before each, handshake() calls this.
class Handshake final : public Transport {
 public:
  Handshake(int socket, std::function<void()> before)
      : Transport(socket), before_(std::move(before)) {}
  [[nodiscard]] bool is_open() const override { return open_; }
  bool handshake() override {
    before_();
    char byte = 0;
    const std::int64_t got = receive(&byte, 1);
    open_ = got == 1 && byte == '!';
    return got == 1 || got == kAgain;
  }

 private:
  const std::function<void()> before_;
  bool open_ = false;
};

class IdleConnectionsTest : public testing::Test {
 protected:
  ~IdleConnectionsTest() override {
    listener_.stop();
    for (const auto& pair : pairs_) ::close(pair[0]);
  }

  void start(milliseconds idle) {
    rules_.idle = idle;
    idle_connections_.emplace(
        listener_,
        IdleConnections::Uses{
            .accept = [] { return std::nullopt; },
            .handshake = [this](Client client) { handshakes_.handshake(std::move(client)); },
            .ready = [this](const Client& client) { ready_.set_value(client.received); },
            .refuse = [](const Client&, const Error&) {}},
        rules_);
    running_ = std::jthread([this] { idle_connections_->run(); });
  }
  /// Our end of a new client's socket.
  int come(std::optional<std::function<void()>> before_greeting = std::nullopt) {
    std::array<int, 2> pair{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, pair.data()), 0);
    pairs_.push_back(pair);
    Client client;
    if (before_greeting)
      client.transport = std::make_unique<Handshake>(pair[1], *before_greeting);
    else
      client.transport = std::make_unique<Transport>(pair[1]);
    idle_connections_->park(std::move(client));
    return pair[0];
  }
  static bool send(int socket, const std::string& bytes) {
    return ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL) > 0;
  }

  IdleRules rules_;
  Listener listener_{"127.0.0.1", 0};
  std::vector<std::array<int, 2>> pairs_;
  std::promise<std::string> ready_;
  std::optional<IdleConnections> idle_connections_;
  TlsHandshakePool handshakes_{
      2, [this](Client client) { idle_connections_->park(std::move(client)); }};
  std::jthread running_;
};

TEST_F(IdleConnectionsTest, OneTooManyDrivesOutWhoWouldBeLateNext) {
  rules_.max_parked = 2;
  start(std::chrono::minutes(1));
  const int first = come();
  const int second = come();
  ASSERT_TRUE(send(first, "G"));  // its head has less time than the idle have
  await([&] { return idle_connections_->count() == 2; });
  const int third = come();
  std::array<pollfd, 1> closed = {pollfd{first, POLLIN, 0}};
  ASSERT_EQ(::poll(closed.data(), 1, 60'000), 1);
  EXPECT_EQ(idle_connections_->count(), 2);
  ASSERT_TRUE(send(second, "G"));
  ASSERT_TRUE(send(third, kHead));
  EXPECT_EQ(ready_.get_future().get(), kHead);
}

TEST_F(IdleConnectionsTest, AHandshakeThatComputesLongDelaysNobody) {
  const auto begun = std::make_shared<std::promise<void>>();
  std::promise<void> release;
  start(std::chrono::minutes(1));
  const int slow = come([begun, released = release.get_future().share()] {  // outlives this test
    begun->set_value();
    released.wait();
  });
  ASSERT_TRUE(send(slow, "!"));
  begun->get_future().wait();
  ASSERT_TRUE(send(come(), kHead));
  EXPECT_EQ(ready_.get_future().get(), kHead);
  ready_ = {};
  const int shaken = come([] {});  // another handshake, too
  ASSERT_TRUE(send(shaken, "!" + kHead));
  EXPECT_EQ(ready_.get_future().get(), kHead);
  release.set_value();
}

TEST_F(IdleConnectionsTest, AHandshakeThatDripsHasOneDeadline) {
  start(milliseconds(200));
  const int slow = come([] {});
  while (send(slow, ".")) std::this_thread::sleep_for(milliseconds(5));  // until it is closed
  EXPECT_EQ(idle_connections_->count(), 0);
}

}  // namespace
}  // namespace unwrapd::server::http
