#pragma once
// A client that speaks in raw bytes, as no library would.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace unwrapd::server {

/// A client that sends what it is told to, right or wrong.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  ~RawClient() { ::close(socket_); }

  void send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  /// Everything until the server closes, which it does when nothing more is
  /// sent.
  std::string finish() const {
    ::shutdown(socket_, SHUT_WR);
    return read_to_end();
  }
  /// What comes until this text has come; less when the server closes before.
  std::string read_until(std::string_view text) {
    std::array<char, 4096> piece;
    std::size_t end = received_.find(text);
    while (end == std::string::npos) {
      const ssize_t got = ::recv(socket_, piece.data(), piece.size(), 0);
      if (got <= 0) return std::exchange(received_, {});
      const std::size_t from = received_.size() - std::min(received_.size(), text.size() - 1);
      received_.append(piece.data(), static_cast<std::size_t>(got));
      end = received_.find(text, from);
    }
    std::string until = received_.substr(0, end + text.size());
    received_.erase(0, until.size());
    return until;
  }
  [[nodiscard]] int socket() const { return socket_; }
  /// What has come, up to so many bytes; 0 when the server has closed.
  std::size_t receive(char* data, std::size_t size) const {
    const ssize_t got = ::recv(socket_, data, size, 0);
    return got > 0 ? static_cast<std::size_t>(got) : 0;
  }
  /// Everything until the server closes.
  std::string read_to_end() const {
    std::string all;
    std::array<char, 4096> piece;
    while (true) {
      const ssize_t got = ::recv(socket_, piece.data(), piece.size(), 0);
      if (got <= 0) return all;
      all.append(piece.data(), static_cast<std::size_t>(got));
    }
  }

 private:
  int socket_;
  std::string received_;  // beyond what was asked for
};

}  // namespace unwrapd::server
