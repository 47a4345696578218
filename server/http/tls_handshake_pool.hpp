#pragma once
// Threads that make the handshakes of TLS. Each step computes for about a millisecond (a
// signature), in which the parking lot's one thread would see nobody else; a client whose handshake
// is slow because it sends slowly waits in the parking lot like any other, and comes here step by
// step.

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "server/http/transport.hpp"

namespace unwrapd::server::http {

class TlsHandshakePool {
 public:
  /// back: gets each client that is still there after its step, from any thread.
  TlsHandshakePool(int threads, std::function<void(Client)> back);

  /// Takes a client that has sent something, for one step. Never waits.
  void handshake(Client client);

 private:
  void work(const std::stop_token& stop);

  const std::function<void(Client)> back_;
  std::mutex mutex_;
  std::condition_variable_any arrived_;
  std::deque<Client> waiting_;
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace unwrapd::server::http
