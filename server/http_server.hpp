#pragma once
// The HTTP edge: connections in, Requests to one answer function, Responses out. cpp-httplib
// parses and writes (http_exchange.hpp); accepting, waiting, framing and limits are ours
// (connection.hpp), since the packaged version keeps its limits for bodies of known length only.

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/connection.hpp"
#include "server/http.hpp"
#include "server/listener.hpp"
#include "server/log.hpp"

namespace unwrapd::server {

struct HttpConfig {
  std::string host = "127.0.0.1";
  int port = 8080;            ///< 0: a free one
  int max_connections = 320;  ///< served at once, a thread each; more wait
  ConnectionLimits limits;
};

class HttpServer {
 public:
  /// Listens at once, and answers when serve() runs. answer is called from many threads and must
  /// not throw. Throws Error when the address cannot be had.
  HttpServer(const HttpConfig& config, Handler answer, const Log& log);

  [[nodiscard]] int port() const { return listener_.port(); }
  /// Serves until stop(), then until the requests at hand are answered.
  void serve();
  void stop();

 private:
  void work();
  void serve_connection(int client);
  void serve_requests(Connection& connection);

  const HttpConfig config_;
  const Handler answer_;
  const Log& log_;
  const Listener listener_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<int> clients_;  // accepted, not yet served
  std::atomic<std::size_t> waiting_ = 0;
  std::atomic<bool> stopping_ = false;
};

}  // namespace unwrapd::server
