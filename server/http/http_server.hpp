#pragma once
// The HTTP edge: connections in, Requests to one answer function, Responses out. A connection
// without a complete head waits in idle_connections.hpp, without a thread. Each request is answered
// by one thread; one thread more writes the bodies of all streams (stream_writer.hpp). cpp-httplib
// parses and writes (http_exchange.hpp); accepting, waiting, framing and limits are our own, as the
// packaged version applies its limits only to bodies of known length.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/base/concurrency_limit.hpp"
#include "server/base/log.hpp"
#include "server/http/addresses.hpp"
#include "server/http/connection.hpp"
#include "server/http/http.hpp"
#include "server/http/http_exchange.hpp"
#include "server/http/idle_connections.hpp"
#include "server/http/listener.hpp"
#include "server/http/stream_writer.hpp"
#include "server/http/tls.hpp"

namespace unwrapd::server::http {

struct HttpConfig {
  Address address{"127.0.0.1", 8080};     ///< port 0: a free one
  std::string_view option = "--listen";   ///< which asks for it
  int max_requests = 320;                 ///< answered at once, a thread each; others wait
  int max_held = 0;                       ///< threads beside those, for requests that wait for work
  int max_connections = 4096;             ///< open at once; more are turned away
  int max_connections_per_address = 0;    ///< not of loopback nor trusted proxies; 0: no limit
  std::filesystem::path tls_certificate;  ///< empty: plain HTTP
  std::filesystem::path tls_key;
  std::chrono::milliseconds last_answers{10'000};  ///< for what is being answered at the end
  std::chrono::milliseconds ping{15'000};          ///< of silence in a stream, until one is sent
  IdleRules idle_connections;
  ConnectionLimits limits;
};

class HttpServer {
 public:
  /// Listens at once, and answers while serve() runs. Throws Error when the address or the
  /// certificate cannot be used.
  HttpServer(const HttpConfig& config, HttpUses uses, const Log& log);

  [[nodiscard]] int port() const { return listener_.port(); }
  /// Serves until stop(), then until the current requests are answered or `last_answers` is over.
  void serve();
  void stop();

  [[nodiscard]] int parked() const { return idle_connections_.count(); }
  [[nodiscard]] int open() const { return places_.count(); }

 private:
  struct Idle;

  std::optional<Client> let_in();
  void turn_away(Client& client, const Error& error) const;
  void make_ready(Client client);
  static void wake(Idle& idle);
  void begin_thread();
  std::optional<Client> next_client();
  void work();
  void end_late();
  void serve_client(Client client, Exchange& exchange);
  void let_go(Client client, bool again);
  void forget(int socket);
  bool serve_requests(Connection& connection, Exchange& exchange);
  void refuse(Connection& connection, const Error& error) const;
  void observe_refusal(const std::string& client, const Error& error, std::int64_t sent) const;

  const HttpConfig config_;
  const HttpUses uses_;
  const Log& log_;
  const std::optional<TlsContext> tls_;
  const Listener listener_;
  ConcurrencyLimit places_;  // of connections, each network its share
  IdleConnections idle_connections_;
  std::optional<TlsHandshakePool> handshakes_;  // with TLS only
  std::mutex mutex_;
  std::condition_variable left_;
  std::deque<Client> ready_;
  std::vector<Idle*> idle_;  // the last to become so at the back
  std::set<int> served_;     // sockets
  std::atomic<bool> stopping_ = false;
  StreamWriter streams_;               // uses the others
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace unwrapd::server::http
