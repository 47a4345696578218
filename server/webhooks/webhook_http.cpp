#include "server/webhooks/webhook_http.hpp"

#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "server/base/deadline.hpp"

namespace unwrapd::server {
namespace {

constexpr std::chrono::seconds kConnectTime{5};
constexpr std::chrono::seconds kWholeTime{15};
constexpr std::size_t kMostStatusLine = 512;
constexpr std::size_t kMostAnswer = std::size_t{16} * 1024;  // bytes, certificates included

/// httplib matches status lines against a regular expression that recurses for every byte: 30 kB of
/// one overflow the stack. Lines that it does not take for such are as long as they like. Within
/// TLS they are not seen here; kMostAnswer keeps them short enough.
class StatusLines {
 public:
  /// False once one is too long.
  bool are_short(std::string_view bytes) {
    for (const char byte : bytes) {
      if (byte == '\n') {
        line_.clear();
      } else if (line_.size() < kMostStatusLine) {
        line_ += byte;
      } else if (line_.starts_with("HTTP/")) {
        return false;
      }
    }
    return true;
  }

 private:
  std::string line_;  // its first bytes
};

/// A Client or an SSLClient that gets no more than so many bytes of an answer: they come to it
/// through a pipe that counts them. httplib itself reads lines without end.
template <class Client>
class Bounded : public Client {
 public:
  using Client::Client;
  Bounded(const Bounded&) = delete;
  Bounded& operator=(const Bounded&) = delete;
  ~Bounded() override {
    for (const int end : {far_, near_}) ::shutdown(end, SHUT_RDWR);
    if (pump_.joinable()) pump_.join();
    for (const int end : {far_, near_}) ::close(end);
  }

 private:
  bool create_and_connect_socket(typename Client::Socket& socket, httplib::Error& error) override {
    std::array<int, 2> pipe{};
    if (far_ >= 0 || !httplib::ClientImpl::create_and_connect_socket(socket, error)) return false;
    far_ = std::exchange(socket.sock, INVALID_SOCKET);
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pipe.data()) != 0) return false;
    near_ = pipe[0];
    socket.sock = pipe[1];
    pump_ = std::jthread([this] { pump(); });
    return true;
  }

  void pump() {
    std::array<char, 4096> bytes{};
    std::size_t answered = 0;
    StatusLines status_lines;
    std::array<pollfd, 2> ends{{{near_, POLLIN, 0}, {far_, POLLIN, 0}}};
    while (answered <= kMostAnswer && ::poll(ends.data(), ends.size(), -1) >= 0) {
      for (const std::size_t from : {0U, 1U}) {
        if (ends.at(from).revents == 0) continue;
        const ssize_t count = ::recv(ends.at(from).fd, bytes.data(), bytes.size(), 0);
        if (count <= 0) return cut();
        const std::string_view piece(bytes.data(), static_cast<std::size_t>(count));
        if (from == 1) answered += piece.size();
        if (from == 1 && !status_lines.are_short(piece)) return cut();
        if (!pass_on(ends.at(1 - from).fd, piece)) return cut();
      }
    }
    cut();
  }

  static bool pass_on(int to, std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::send(to, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }

  void cut() const {
    for (const int end : {far_, near_}) ::shutdown(end, SHUT_RDWR);
  }

  int far_ = -1;
  int near_ = -1;
  std::jthread pump_;
};

template <class Client>
std::string post(Client& client, const WebhookCall& call, const std::stop_token& stop) {
  client.set_hostname_addr_map({{call.url.host, call.address}});
  client.set_connection_timeout(kConnectTime);
  client.set_read_timeout(kWholeTime);
  client.set_write_timeout(kWholeTime);
  client.set_follow_location(false);
  int status = 0;
  httplib::Request request;
  request.method = "POST";
  request.path = call.url.target;
  for (const auto& [name, value] : call.headers) request.set_header(name.c_str(), value);
  request.set_header("Content-Type", "application/json");
  request.set_header("User-Agent", "unwrapd/" UNWRAPD_VERSION);
  request.body = call.body;
  request.response_handler = [&](const httplib::Response& answer) {
    status = answer.status;
    return false;  // the body is not read: it may have no end
  };
  const Deadline slow(kWholeTime, [&] { client.stop(); });
  const std::stop_callback cut(stop, [&] { client.stop(); });
  const httplib::Result result = client.send(request);
  if (result) status = result->status;  // of an answer that can have no body, such as 204
  if (status >= 200 && status < 300) return {};
  if (status != 0) return "status " + std::to_string(status);
  return "no answer: " + httplib::to_string(result.error());
}

}  // namespace

std::string post_webhook(const WebhookCall& call, const std::stop_token& stop) {
  if (call.url.is_https) {
    Bounded<httplib::SSLClient> client(call.url.host, call.url.port);
    return post(client, call, stop);
  }
  Bounded<httplib::ClientImpl> client(call.url.host, call.url.port);
  return post(client, call, stop);
}

}  // namespace unwrapd::server
