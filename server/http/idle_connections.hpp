#pragma once
// Connections without a complete request wait here, all in one thread: an idle one costs a few
// hundred bytes, a slow one its bytes so far, and neither costs a thread. A connection with a
// complete head (or one that is too long) goes to the threads that answer.
//
// Each connection has a deadline: `idle` while it has sent nothing, `head` from its first byte to
// the empty line, however steadily it drips (slow loris). Epoll is level triggered: it reports
// again a client that was not read to its end. Rejected: a thread a connection, which 64 slow
// clients used up.

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

  /// Runs until the listener is stopped; then closes all connections that wait.
  void run();
  /// Waits once, for at most so long (-1: without limit), and handles the events.
  void turn(int patience_ms);
  /// Closes connections whose deadline has passed at this moment.
  void expire(Clock::time_point now);
  /// Takes a client back, from any thread, until its next request or the next step of its
  /// handshake.
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
