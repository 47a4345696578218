#pragma once
// TLS by OpenSSL, for servers without a proxy in front: TLS 1.2 and 1.3, one certificate. The
// handshake is part of the first bytes, under the same deadlines as a slow head.

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "server/http/transport.hpp"

struct ssl_ctx_st;  // OpenSSL's SSL_CTX

namespace unwrapd::server::http {

/// A certificate with its key.
class TlsContext {
 public:
  /// PEM files: a certificate with its chain, and its key. Throws
  /// Error{internal} saying which of them cannot be used.
  TlsContext(const std::filesystem::path& certificate, const std::filesystem::path& key);

  /// Takes over a socket that does not block.
  [[nodiscard]] std::unique_ptr<Transport> accept(int socket) const;

 private:
  struct Free {
    void operator()(ssl_ctx_st* context) const;
  };
  std::unique_ptr<ssl_ctx_st, Free> context_;
};

/// Threads for handshakes. Each step computes for about a millisecond (a signature), in which the
/// one thread of the idle connections could serve no other client. A client whose handshake is slow
/// because it sends slowly waits among the idle connections, and comes here step by step.
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
