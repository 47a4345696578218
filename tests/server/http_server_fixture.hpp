#pragma once
// An HttpServer by itself on a free port, what it answers, and what it tells of it.

#include "server/http/http_server.hpp"

#include "running_server.hpp"  // Eigen before httplib, whose headers define _res

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "raw_client.hpp"

namespace unwrapd::server {

class HttpServerTest : public testing::Test {
 protected:
  HttpServerTest() {
    config_.address.port = 0;
    config_.max_requests = 4;
    config_.limits.max_body_bytes = 1'000'000;
    config_.limits.head = std::chrono::milliseconds(1000);
  }
  ~HttpServerTest() override { stop(); }

  void start() {
    server_ = std::make_unique<http::HttpServer>(
        config_,
        http::HttpUses{.answer = [this](const http::Request& request) { return answer_(request); },
                       .observe = [this](const http::Exchanged& done) { observe(done); },
                       .trusted_proxies = proxies_,
                       .news = news_},
        log_);
    serving_ = std::jthread([this] { server_->serve(); });
  }
  void stop() {
    if (server_) server_->stop();
    if (serving_.joinable()) serving_.join();
  }
  void observe(const http::Exchanged& done) {
    const std::lock_guard lock(mutex_);
    seen_.push_back(done);
  }
  std::size_t refused(std::string_view problem) {
    const std::lock_guard lock(mutex_);
    return static_cast<std::size_t>(std::ranges::count(seen_, problem, &http::Exchanged::problem));
  }
  [[nodiscard]] std::unique_ptr<RawClient> connect() const {
    return std::make_unique<RawClient>(server_->port());
  }
  [[nodiscard]] std::string get() const {
    const auto client = connect();
    client->send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
    return client->finish();
  }

  http::HttpConfig config_;
  http::AddressSet proxies_;
  std::function<http::Response(const http::Request&)> answer_ = [](const http::Request& request) {
    return http::json_response(200, "\"" + request.client + "\"");
  };
  std::shared_ptr<Wakeup> news_ = std::make_shared<Wakeup>();
  Log log_{LogLevel::off};
  std::unique_ptr<http::HttpServer> server_;
  std::jthread serving_;
  std::mutex mutex_;
  std::vector<http::Exchanged> seen_;
};

/// PEM files of a certificate of receiver.example that signs itself, and its key.
inline void write_certificate(const std::string& certificate, const std::string& key) {
  EVP_PKEY* pair = EVP_EC_gen("P-256");
  X509* own = X509_new();
  X509_gmtime_adj(X509_getm_notBefore(own), 0);
  X509_gmtime_adj(X509_getm_notAfter(own), 3600);
  X509_set_pubkey(own, pair);
  X509_set_version(own, X509_VERSION_3);
  X509_NAME* const subject = X509_get_subject_name(own);
  X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>("receiver"), -1, -1, 0);
  X509_set_issuer_name(own, subject);
  X509_EXTENSION* name = X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name,
                                             "DNS:receiver.example,DNS:localhost");
  X509_add_ext(own, name, -1);
  X509_EXTENSION_free(name);
  X509_sign(own, pair, EVP_sha256());
  const auto close = [](std::FILE* file) { std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(close)> to(std::fopen(certificate.c_str(), "w"), close);
  const std::unique_ptr<std::FILE, decltype(close)> key_to(std::fopen(key.c_str(), "w"), close);
  PEM_write_X509(to.get(), own);
  PEM_write_PrivateKey(key_to.get(), pair, nullptr, nullptr, 0, nullptr, nullptr);
  X509_free(own);
  EVP_PKEY_free(pair);
}

}  // namespace unwrapd::server
