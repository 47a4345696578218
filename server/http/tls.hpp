#pragma once
// TLS by OpenSSL, for those who have no proxy before the server: TLS 1.2
// and 1.3, one certificate. The handshake is part of the first bytes; it takes
// the same deadlines as a slow head, and threads of its own (tls_handshake_pool.hpp).

#include <filesystem>
#include <memory>

#include "server/http/transport.hpp"

struct ssl_ctx_st;  // OpenSSL's SSL_CTX

namespace unwrapd::server::http {

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

}  // namespace unwrapd::server::http
