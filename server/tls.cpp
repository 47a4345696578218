#include "server/tls.hpp"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <poll.h>

#include <algorithm>
#include <limits>
#include <system_error>
#include <utility>

#include "core/error.hpp"

namespace unwrapd::server {
namespace {

struct FreeSsl {
  void operator()(SSL* ssl) const { SSL_free(ssl); }
};
using Session = std::unique_ptr<SSL, FreeSsl>;

int clamped(std::size_t size) {
  return static_cast<int>(std::min<std::size_t>(size, std::numeric_limits<int>::max()));
}

class TlsTransport final : public Transport {
 public:
  TlsTransport(int socket, Session session) : Transport(socket), session_(std::move(session)) {
    SSL_set_fd(session_.get(), socket);
    SSL_set_accept_state(session_.get());
  }

  [[nodiscard]] bool is_open() const override { return SSL_is_init_finished(session_.get()) == 1; }
  bool greet() override {
    ERR_clear_error();
    const std::int64_t done = result_of(SSL_do_handshake(session_.get()));
    return done > 0 || done == kAgain;
  }
  std::int64_t receive(char* data, std::size_t size) override {
    ERR_clear_error();
    return result_of(SSL_read(session_.get(), data, clamped(size)));
  }
  std::int64_t send(std::string_view bytes) override {
    ERR_clear_error();
    return result_of(SSL_write(session_.get(), bytes.data(), clamped(bytes.size())));
  }
  [[nodiscard]] short awaits(short wanted) const override {
    if (wants_ == SSL_ERROR_WANT_READ) return POLLIN;
    if (wants_ == SSL_ERROR_WANT_WRITE) return POLLOUT;
    return wanted;
  }
  void end() override {
    ERR_clear_error();
    if (!broken_ && SSL_is_init_finished(session_.get())) SSL_shutdown(session_.get());
    Transport::end();
  }

 private:
  std::int64_t result_of(int count) {
    wants_ = count > 0 ? SSL_ERROR_NONE : SSL_get_error(session_.get(), count);
    if (count > 0) return count;
    if (wants_ == SSL_ERROR_ZERO_RETURN) return 0;
    if (wants_ == SSL_ERROR_WANT_READ || wants_ == SSL_ERROR_WANT_WRITE) return kAgain;
    broken_ = true;
    return kBroken;
  }

  Session session_;
  int wants_ = SSL_ERROR_NONE;
  bool broken_ = false;
};

/// Of the first thing that went wrong: the rest follows from it.
std::string reason_of_failure() {
  const unsigned long code = ERR_peek_error();
  if (ERR_SYSTEM_ERROR(code)) return std::generic_category().message(ERR_GET_REASON(code));
  const char* text = ERR_reason_error_string(code);
  return text ? text : "no reason is known";
}

[[noreturn]] void unusable(const std::filesystem::path& file, const std::string& option) {
  throw Error(ErrorCode::internal, "The file " + file.string() + " of " + option +
                                       " cannot be used (" + reason_of_failure() +
                                       "); give a PEM file that the server's user may read.");
}

/// Nobody is asked for a pass phrase: a server starts without a terminal.
int no_pass_phrase(char*, int, int, void* asked) {
  *static_cast<bool*>(asked) = true;
  return -1;
}

void use_key(SSL_CTX* context, const std::filesystem::path& key) {
  bool asked = false;
  SSL_CTX_set_default_passwd_cb(context, no_pass_phrase);
  SSL_CTX_set_default_passwd_cb_userdata(context, &asked);
  const int used = SSL_CTX_use_PrivateKey_file(context, key.c_str(), SSL_FILETYPE_PEM);
  SSL_CTX_set_default_passwd_cb_userdata(context, nullptr);
  if (asked) {
    throw Error(ErrorCode::internal, "The file " + key.string() +
                                         " of --tls-key is encrypted; give the key without a pass "
                                         "phrase (openssl pkey -in FILE -out PLAIN).");
  }
  if (used != 1 || SSL_CTX_check_private_key(context) != 1) unusable(key, "--tls-key");
}

}  // namespace

void TlsContext::Free::operator()(ssl_ctx_st* context) const { SSL_CTX_free(context); }

TlsContext::TlsContext(const std::filesystem::path& certificate, const std::filesystem::path& key)
    : context_(SSL_CTX_new(TLS_server_method())) {
  SSL_CTX* context = context_.get();
  ERR_clear_error();
  SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
  SSL_CTX_set_options(context, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION |
                                   SSL_OP_CIPHER_SERVER_PREFERENCE | SSL_OP_IGNORE_UNEXPECTED_EOF);
  SSL_CTX_set_mode(context, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER |
                                SSL_MODE_RELEASE_BUFFERS);
  if (SSL_CTX_use_certificate_chain_file(context, certificate.c_str()) != 1)
    unusable(certificate, "--tls-cert");
  use_key(context, key);
}

std::unique_ptr<Transport> TlsContext::accept(int socket) const {
  return std::make_unique<TlsTransport>(socket, Session(SSL_new(context_.get())));
}

}  // namespace unwrapd::server
