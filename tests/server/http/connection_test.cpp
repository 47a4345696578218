// A connection by itself, over a pair of sockets: what comes too late or not at all.
#include "server/http/connection.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string>
#include <thread>

namespace unwrapd::server::http {
namespace {

using std::chrono::milliseconds;

class ConnectionTest : public testing::Test {
 protected:
  ConnectionTest() {
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets_.data()), 0);
    limits_.max_body_bytes = 100;
  }
  ~ConnectionTest() override { hang_up(); }

  void send(const std::string& bytes) { ::send(sockets_[0], bytes.data(), bytes.size(), 0); }
  void hang_up() {
    if (sockets_[0] >= 0) ::close(sockets_[0]);
    sockets_[0] = -1;
  }
  Connection& connection() {
    if (!connection_)
      connection_ = std::make_unique<Connection>(
          Client{.transport = std::make_unique<Transport>(sockets_[1])}, -1, limits_);
    return *connection_;
  }
  ErrorCode refusal() {
    try {
      connection().next_request();
      ADD_FAILURE() << "not refused";
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::internal;
  }
  std::string read_all() {
    std::string all;
    std::array<char, 7> piece;
    while (true) {
      const std::int64_t got = connection().read(piece.data(), piece.size());
      if (got <= 0) return all;
      all.append(piece.data(), static_cast<std::size_t>(got));
    }
  }

  std::array<int, 2> sockets_{-1, -1};
  ConnectionLimits limits_;
  std::unique_ptr<Connection> connection_;
};

const std::string kHead = "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\n";

TEST_F(ConnectionTest, HandsOutTheHeadAndThenTheBody) {
  send(kHead + "helloGET / HTTP/1.1\r\nHost: x\r\n\r\n");
  ASSERT_TRUE(connection().next_request());
  EXPECT_EQ(read_all(), kHead + "hello");
  EXPECT_TRUE(connection().is_read());
  ASSERT_TRUE(connection().next_request());
  EXPECT_EQ(read_all(), "GET / HTTP/1.1\r\nHost: x\r\n\r\n");
}

TEST_F(ConnectionTest, HalfAHeadIsATimeout) {
  limits_.head = milliseconds(20);
  send("GET / HT");
  EXPECT_EQ(refusal(), ErrorCode::request_timeout);
}

TEST_F(ConnectionTest, SilenceAndALeavingClientAreTheEnd) {
  limits_.idle = milliseconds(20);
  EXPECT_FALSE(connection().next_request());
  send("GET / HT");
  hang_up();
  EXPECT_FALSE(connection().next_request());
}

TEST_F(ConnectionTest, HalfABodyIsATimeout) {
  limits_.read = milliseconds(20);
  send(kHead + "he");
  ASSERT_TRUE(connection().next_request());
  EXPECT_EQ(read_all(), kHead + "he");
  ASSERT_TRUE(connection().failure());
  EXPECT_EQ(connection().failure()->code(), ErrorCode::request_timeout);
  EXPECT_FALSE(connection().is_read());
  hang_up();
}

TEST_F(ConnectionTest, ABodyThatDripsKeepsALeastRate) {
  limits_.max_body_bytes = 1'000'000;
  limits_.rate_grace = milliseconds(50);
  limits_.min_bytes_per_second = 100'000'000;
  send("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 1000000\r\n\r\n");
  ASSERT_TRUE(connection().next_request());
  std::array<char, 512> piece;
  for (std::int64_t got = 1; got > 0; got = connection().read(piece.data(), piece.size()))
    send("x");  // in time each
  EXPECT_EQ(connection().failure()->code(), ErrorCode::request_timeout);
  hang_up();
}

TEST_F(ConnectionTest, AnAnswerThatIsTakenInDripsKeepsALeastRate) {
  limits_.rate_grace = milliseconds(50);
  limits_.min_bytes_per_second = 100'000'000;
  send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
  ASSERT_TRUE(connection().next_request());
  std::jthread drip([&](const std::stop_token& stop) {
    std::array<char, 5000> piece;
    for (; !stop.stop_requested(); std::this_thread::sleep_for(milliseconds(5)))
      ::recv(sockets_[0], piece.data(), piece.size(), MSG_DONTWAIT);
  });
  const std::string bytes(100'000, 'x');
  int writes = 0;
  while (writes < 1000 && connection().write(bytes) >= 0) ++writes;
  EXPECT_LT(writes, 1000);
  drip = {};
  hang_up();
}

TEST_F(ConnectionTest, ManySmallChunksKeepTheLimitToo) {
  send("POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n");
  for (int k = 0; k < 101; ++k) send("1\r\nx\r\n");
  ASSERT_TRUE(connection().next_request());
  const std::string all = read_all();
  EXPECT_EQ(all.substr(all.find("\r\n\r\n") + 4), std::string(100, 'x'));
  EXPECT_EQ(connection().failure()->code(), ErrorCode::body_too_large);
  hang_up();
}

}  // namespace
}  // namespace unwrapd::server::http
