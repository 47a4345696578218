#pragma once
// A TLS server on a free port that answers every request by the same bytes, whatever they are. Its
// certificate signs itself; the client trusts it through SSL_CERT_FILE while the server lives.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {

class TlsServer {
 public:
  explicit TlsServer(std::string answer)
      : answer_(std::move(answer)), context_(SSL_CTX_new(TLS_server_method()), SSL_CTX_free) {
    std::signal(SIGPIPE, SIG_IGN);  // as the program does; the client may hang up
    take_certificate();
    listen();
    thread_ = std::thread([this] { serve(); });
  }
  TlsServer(const TlsServer&) = delete;
  TlsServer& operator=(const TlsServer&) = delete;
  ~TlsServer() {
    ::shutdown(socket_, SHUT_RDWR);
    thread_.join();
    ::close(socket_);
    ::unsetenv("SSL_CERT_FILE");
  }

  [[nodiscard]] std::string address() const { return "https://127.0.0.1:" + std::to_string(port_); }

 private:
  void take_certificate() {
    const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> pair(EVP_EC_gen("P-256"),
                                                                   EVP_PKEY_free);
    const std::unique_ptr<X509, decltype(&X509_free)> own(X509_new(), X509_free);
    X509_gmtime_adj(X509_getm_notBefore(own.get()), -60);
    X509_gmtime_adj(X509_getm_notAfter(own.get()), 3600);
    X509_set_pubkey(own.get(), pair.get());
    X509_set_version(own.get(), X509_VERSION_3);
    X509_NAME* const subject = X509_get_subject_name(own.get());
    X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC,
                               reinterpret_cast<const unsigned char*>("test"), -1, -1, 0);
    X509_set_issuer_name(own.get(), subject);
    const std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> name(
        X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, "IP:127.0.0.1"),
        X509_EXTENSION_free);
    X509_add_ext(own.get(), name.get(), -1);
    X509_sign(own.get(), pair.get(), EVP_sha256());
    const std::string file = folder_.file("certificate.pem");
    std::FILE* const to = std::fopen(file.c_str(), "w");
    PEM_write_X509(to, own.get());
    std::fclose(to);
    ::setenv("SSL_CERT_FILE", file.c_str(), 1);
    SSL_CTX_use_certificate(context_.get(), own.get());
    SSL_CTX_use_PrivateKey(context_.get(), pair.get());
  }

  void listen() {
    socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(at);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&at), size), 0);
    EXPECT_EQ(::listen(socket_, 8), 0);
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&at), &size);
    port_ = ntohs(at.sin_port);
  }

  void serve() {
    for (int socket = ::accept(socket_, nullptr, nullptr); socket >= 0;
         socket = ::accept(socket_, nullptr, nullptr)) {
      const std::unique_ptr<SSL, decltype(&SSL_free)> tls(SSL_new(context_.get()), SSL_free);
      SSL_set_fd(tls.get(), socket);
      if (SSL_accept(tls.get()) == 1) answer(tls.get());
      ::close(socket);
    }
  }

  /// Once the head is read and, where it announces a megabyte, so much more.
  void answer(SSL* tls) {
    std::string seen;
    std::array<char, 16384> block;
    std::size_t wanted = std::string::npos;
    while (seen.size() < wanted) {
      const int count = SSL_read(tls, block.data(), static_cast<int>(block.size()));
      if (count <= 0) return;
      seen.append(block.data(), static_cast<std::size_t>(count));
      const std::size_t end = seen.find("\r\n\r\n");
      if (end == std::string::npos) continue;
      const bool is_long = seen.find("Content-Length: 1000000\r\n") < end;
      wanted = end + 4 + (is_long ? 1'000'000 : 0);
    }
    SSL_write(tls, answer_.data(), static_cast<int>(answer_.size()));
    SSL_shutdown(tls);
  }

  const std::string answer_;
  const TemporaryFolder folder_;
  std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context_;
  int socket_ = -1;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace unwrapd::client
