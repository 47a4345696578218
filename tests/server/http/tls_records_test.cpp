// What a client may send inside TLS beside its data, on a real connection.
#include "tests/server/http_server_fixture.hpp"

#include <gmock/gmock.h>
#include <openssl/ssl.h>

#include <atomic>
#include <csignal>

namespace unwrapd::server::http {
namespace {

using testing::HasSubstr;

/// A client of OpenSSL's own, which can send what httplib never does.
class TlsClient {
 public:
  explicit TlsClient(int port) : raw_(port), context_(SSL_CTX_new(TLS_client_method())) {
    session_ = SSL_new(context_);
    SSL_set_fd(session_, raw_.socket());
    EXPECT_EQ(SSL_connect(session_), 1);
  }
  TlsClient(const TlsClient&) = delete;
  TlsClient& operator=(const TlsClient&) = delete;
  ~TlsClient() {
    SSL_free(session_);
    SSL_CTX_free(context_);
  }

  /// False once the server has closed.
  bool update_key(int kind) {
    return SSL_key_update(session_, kind) == 1 && SSL_do_handshake(session_) == 1;
  }
  bool send(std::string_view text) {
    return SSL_write(session_, text.data(), static_cast<int>(text.size())) > 0;
  }
  /// The status line of the answer; empty when the server has closed.
  std::string answer() {
    std::string text(12, ' ');
    const int got = SSL_read(session_, text.data(), static_cast<int>(text.size()));
    return text.substr(0, static_cast<std::size_t>(std::max(got, 0)));
  }

 private:
  RawClient raw_;
  SSL_CTX* context_;
  SSL* session_ = nullptr;
};

class TlsRecords : public HttpServerTest {
 protected:
  TlsRecords() {
    std::signal(SIGPIPE, SIG_IGN);  // OpenSSL's client writes to what the server has closed
    config_.tls_certificate = dir_.path() / "cert.pem";
    config_.tls_key = dir_.path() / "key.pem";
    config_.limits.head = std::chrono::seconds(60);
    config_.idle_connections.head = std::chrono::seconds(60);
    write_certificate(config_.tls_certificate, config_.tls_key);
    start();
  }
  /// What is answered to a request after so many KeyUpdates, the first part of it before them.
  std::string answer_after(int updates, int kind, std::string_view before) {
    TlsClient client(server_->port());
    const std::string request = "GET / HTTP/1.1\r\nHost: x\r\n\r\n";
    if (!before.empty()) client.send(before);
    for (int k = 0; k < updates; ++k)
      if (!client.update_key(kind)) return "";
    client.send(std::string_view(request).substr(before.size()));
    return client.answer();
  }

  TempDir dir_;
};

TEST_F(TlsRecords, AFewKeyUpdatesAreFineAndMoreEndTheConnection) {
  for (const int kind : {SSL_KEY_UPDATE_NOT_REQUESTED, SSL_KEY_UPDATE_REQUESTED})
    for (const char* before : {"", "GET /"}) {
      EXPECT_THAT(answer_after(16, kind, before), HasSubstr("200"));
      EXPECT_EQ(answer_after(17, kind, before), "");
    }
}

TEST_F(TlsRecords, AFloodOfKeyUpdatesHoldsNobodyUp) {
  std::vector<std::jthread> floods;
  std::atomic<int> sent = 0;
  for (int k = 0; k < 4; ++k)
    floods.emplace_back([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        TlsClient client(server_->port());
        for (int n = 0; n < 100'000 && !stop.stop_requested(); ++n, ++sent)
          if (!client.update_key(SSL_KEY_UPDATE_NOT_REQUESTED)) break;
      }
    });
  await([&] { return sent > 1000; });
  for (int k = 0; k < 5; ++k) EXPECT_THAT(answer_after(0, 0, ""), HasSubstr("200"));
}

}  // namespace
}  // namespace unwrapd::server::http
