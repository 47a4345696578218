#pragma once
// One thread writes all answers whose body comes over time (event streams). It never waits for a
// client: at most a few kB that a client does not take now are kept, and no more is fetched for it
// until they are sent. A client that takes nothing for long is cut off. Rejected: a thread a
// stream, whose stack and allocation caches took 42 kB of memory each.

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/base/wakeup.hpp"
#include "server/http/connection.hpp"
#include "server/http/epoll.hpp"
#include "server/http/http.hpp"
#include "server/http/transport.hpp"

namespace unwrapd::server::http {

/// An answer whose head has been sent.
struct OpenStream {
  StreamBody body;
  Exchanged done = {};  ///< as far as it is known; told to the observer at the end
  std::string trace = {};
  std::chrono::steady_clock::time_point began = {};  ///< of the exchange
  bool last = false;                                 ///< the connection ends with it
  bool chunked = true;                               ///< or the body as it is, for HTTP/1.0
};

class StreamWriter {
 public:
  struct Uses {
    std::shared_ptr<Wakeup> news;  ///< rung when a body may have more; used by this object alone
    Observer observe;
    /// Gets each client whose stream is over; again: it may send another request.
    std::function<void(Client, bool again)> back;
  };
  using Clock = std::chrono::steady_clock;

  /// ping: of silence, before a body's ping is sent. Of the limits, those of writing count.
  StreamWriter(Uses uses, const ConnectionLimits& limits, std::chrono::milliseconds ping);
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;
  ~StreamWriter() { stop(); }

  /// Takes over a client, from any thread. Never waits.
  void take(Client client, OpenStream stream);
  /// Cuts off the remaining clients. Call take() no more after it.
  void stop();

 private:
  struct Stream {
    Client client;
    OpenStream open;
    std::string unsent = {};  // framed
    bool ended = false;       // the body has no more
    Clock::time_point last_sent = Clock::now();
    std::optional<Clock::time_point> waiting_since = {};  // for the client, to take more
    std::chrono::duration<double> kept_waiting = {};
    std::int64_t sent_bytes = 0;
  };
  using Streams = std::map<int, Stream>;  // by socket

  void work();
  void turn(int patience_ms);
  void attend(int descriptor, unsigned events);
  void admit();
  void go_on_all();
  enum class Progress { none, some, failed };
  void go_on(Streams::iterator at);
  Progress send_next(Stream& stream) const;
  static void fetch(Stream& stream);
  bool send_unsent(Stream& stream) const;
  void look_after(Clock::time_point now);
  [[nodiscard]] bool is_too_slow(const Stream& stream, Clock::time_point now) const;
  void finish(Streams::iterator at, bool again);

  const Uses uses_;
  const ConnectionLimits limits_;
  const std::chrono::milliseconds ping_;
  Epoll epoll_;
  Streams streams_;
  bool more_ = false;  // a body may have more without a ring
  Clock::time_point next_look_{};
  std::mutex mutex_;
  std::vector<std::pair<Client, OpenStream>> arrived_;
  bool stopped_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace unwrapd::server::http
