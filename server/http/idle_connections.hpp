#pragma once
// Connections that have no complete request yet wait here, all in one thread:
// an idle one costs a few hundred bytes, a slow one its bytes so far, and
// neither a thread. What has a complete head (or too long a one) goes to those
// who answer.
//
// Each has a deadline: `idle` while it has sent nothing, `head` from its first
// byte to the empty line, however steadily it drips (slow loris). Epoll is
// level triggered: a client that is not read to the end now is told of again.
// Rejected: a thread a connection, which 64 slow clients used up.

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <vector>

#include "core/base/error.hpp"
#include "server/base/wakeup.hpp"
#include "server/http/epoll.hpp"
#include "server/http/listener.hpp"
#include "server/http/transport.hpp"

namespace unwrapd::server::http {

struct IdleRules {
  std::chrono::milliseconds idle{15'000};  ///< without a byte of a request
  std::chrono::milliseconds head{10'000};  ///< from the first byte to the empty line
  int max_idle = 1024;                     ///< without a byte; one more drives out the longest
  int max_parked = 0;  ///< without a whole head; one more drives out the next to be late; 0: any
};

class IdleConnections {
 public:
  struct Uses {
    std::function<std::optional<Client>()> accept;  ///< the next that waits to be let in, if any
    std::function<void(Client)> handshake;          ///< has sent a part of its handshake
    std::function<void(Client)> ready;              ///< has sent a head, or more than one may have
    std::function<void(Client&, const Error&)> refuse;
  };
  using Clock = std::chrono::steady_clock;

  IdleConnections(const Listener& listener, Uses uses, const IdleRules& rules);

  /// Until the listener is stopped; then all that are parked are closed.
  void run();
  /// One wait of at most so long (-1: as long as it takes), and what comes of it.
  void turn(int patience_ms);
  /// Closes those whose time is over at this moment.
  void expire(Clock::time_point now);
  /// Takes a client back, from any thread, to wait for its next request, or for the next step of
  /// its handshake.
  void park(Client client);
  [[nodiscard]] int count() const { return count_; }

 private:
  struct IdleConnection {
    Client client;
    Clock::time_point until;
    short awaits;
    bool complete;  // has a whole head
  };
  using Lot = std::map<int, IdleConnection>;  // by socket

  void let_in();
  void take_back();
  void admit(Client client);
  void look_at(Lot::iterator at);
  bool receive(IdleConnection& parked);
  Client remove(Lot::iterator at);
  void drive_out_longest_idle();
  void drive_out_next_late();
  void attend(int descriptor);
  void close_late(Lot::iterator at);

  const Listener& listener_;
  const Uses uses_;
  const IdleRules rules_;
  Epoll epoll_;
  Wakeup wakeup_;
  Lot lot_;
  Clock::time_point next_expiry_{};
  bool stopped_ = false;
  std::atomic<int> count_ = 0;
  std::mutex mutex_;
  std::vector<Client> returned_;
};

}  // namespace unwrapd::server::http
