// The parking lot under clients that come, send in pieces, leave, and come back after an answer;
// who does what is told by the bytes. What it hands on is what was sent, and is a head or too long
// for one.
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "server/http/http_head.hpp"
#include "server/http/idle_connections.hpp"
#include "tests/fuzz/targets.hpp"

namespace unwrapd::fuzz {
namespace {

constexpr std::size_t kPeers = 8;
constexpr int kMaxIdle = 3;
constexpr std::string_view kHeadEnd = "\r\n\r\n";

/// Opens with a handshake of two bytes, each a step.
class Shy final : public server::http::Transport {
 public:
  using server::http::Transport::Transport;
  [[nodiscard]] bool is_open() const override { return steps_ == 2; }
  bool handshake() override {
    char byte = 0;
    const std::int64_t got = receive(&byte, 1);
    steps_ += got == 1 ? 1 : 0;
    return got == 1 || got == kAgain;
  }

 private:
  int steps_ = 0;
};

/// The other end of a client.
struct Peer {
  int socket = -1;
  std::string name;     // which the client has as its address
  std::string sent;     // and not yet handed on
  std::size_t shy = 0;  // bytes that its handshake takes
};

class Play {
 public:
  Play() : idle_connections_(door(), uses(), {.max_idle = kMaxIdle}) {}
  Play(const Play&) = delete;
  Play& operator=(const Play&) = delete;
  ~Play() {
    for (const Peer& peer : peers_)
      if (peer.socket >= 0) ::close(peer.socket);
  }

  /// Each byte: what is done, and by whom.
  void perform(std::string_view script) {
    while (!script.empty()) {
      const auto byte = static_cast<unsigned char>(script.front());
      script.remove_prefix(1);
      Peer& peer = peers_.at(byte / 8U % kPeers);
      if (byte % 8U == 2 && !script.empty()) {
        const std::size_t size = static_cast<unsigned char>(script.front()) % 16U;
        send(peer, script.substr(0, size));
        script.remove_prefix(std::min(size, script.size()));
      }
      act(peer, byte);
      idle_connections_.turn(0);
    }
    for (Peer& peer : peers_) leave(peer);
    for (int i = 0; i < 3; ++i) idle_connections_.turn(0);  // a handshake is handed out and back
    promise(idle_connections_.count() == 0, "who has left is not parked");
  }

 private:
  static const server::http::Listener& door() {
    static const server::http::Listener listener("127.0.0.1", 0);
    return listener;
  }

  server::http::IdleConnections::Uses uses() {
    return {.accept = [] { return std::nullopt; },
            .handshake =
                [this](server::http::Client client) {
                  if (client.transport->handshake()) idle_connections_.park(std::move(client));
                },
            .ready = [this](server::http::Client client) { take(std::move(client)); },
            .refuse =
                [](const server::http::Client& client, const Error& why) {
                  promise(!client.received.empty() && why.code() == ErrorCode::request_timeout,
                          "only who began is told that it is late");
                }};
  }

  void act(Peer& peer, unsigned char byte) {
    switch (byte % 8U) {
      case 0:
      case 1:
        return come(peer, byte % 8U == 1);
      case 3:
        return send(peer, kHeadEnd);
      case 4:
        return send(peer, std::string(4000, 'a'));
      case 5:
        return leave(peer);
      case 6:
        return give_back();
      case 7:
        return idle_connections_.expire(server::http::IdleConnections::Clock::now() +
                                        std::chrono::hours(byte / 128));
      default:
        return;
    }
  }

  void come(Peer& peer, bool shy) {
    leave(peer);
    std::array<int, 2> ends{};
    promise(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends.data()) == 0,
            "there are sockets");
    peer = {.socket = ends[0], .name = std::to_string(++came_), .sent = {}, .shy = shy ? 2U : 0U};
    server::http::Client client{.transport = nullptr, .address = peer.name};
    if (shy)
      client.transport = std::make_unique<Shy>(ends[1]);
    else
      client.transport = std::make_unique<server::http::Transport>(ends[1]);
    idle_connections_.park(std::move(client));
  }

  static void send(Peer& peer, std::string_view bytes) {
    if (peer.socket < 0 || bytes.empty()) return;
    const ssize_t sent = ::send(peer.socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) peer.sent += bytes.substr(0, static_cast<std::size_t>(sent));
  }

  static void leave(Peer& peer) {
    if (peer.socket >= 0) ::close(peer.socket);
    peer = {};
  }

  /// What has a head, or more than one may have.
  void take(server::http::Client client) {
    const std::size_t head = client.received.find(kHeadEnd);
    promise(head != std::string::npos || client.received.size() > server::http::kMaxHeadBytes,
            "who is ready has a head, or too long a one");
    const auto peer = std::ranges::find(peers_, client.address, &Peer::name);
    if (peer != peers_.end()) {
      const std::string_view sent(peer->sent);
      promise(sent.substr(std::min(peer->shy, sent.size())).starts_with(client.received),
              "what is handed on is what was sent");
    }
    ready_.push_back(std::move(client));
  }

  /// As after an answer: the head is used, what follows it is not.
  void give_back() {
    if (ready_.empty()) return;
    server::http::Client client = std::move(ready_.back());
    ready_.pop_back();
    const std::size_t end = client.received.find(kHeadEnd);
    if (end == std::string::npos) return;
    const std::size_t used = end + kHeadEnd.size();
    const auto peer = std::ranges::find(peers_, client.address, &Peer::name);
    if (peer != peers_.end()) {
      peer->sent.erase(0, peer->shy + used);
      peer->shy = 0;
    }
    client.received.erase(0, used);
    idle_connections_.park(std::move(client));
  }

  std::array<Peer, kPeers> peers_{};
  int came_ = 0;
  std::vector<server::http::Client> ready_;
  server::http::IdleConnections idle_connections_;
};

void idle_connections(std::string_view bytes) { Play().perform(bytes.substr(0, 400)); }

std::vector<std::string> seeds() {
  return {std::string("\x00\x02\x05GET /\r\n\x03\x06\x03\x06", 13), "\x09\x0a\x03hello\x0b\x0e\x0d",
          "\x10\x14\x14\x14\x14\x14\x14\x14\x14\x14\x17\x87\x10\x18\x20\x28\x30"};
}

}  // namespace

Target parking_target() { return {"parking", idle_connections, seeds}; }

}  // namespace unwrapd::fuzz
