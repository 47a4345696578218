#include "server/http/tls.hpp"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <poll.h>

#include <algorithm>
#include <limits>
#include <system_error>
#include <utility>

#include "core/base/error.hpp"

namespace unwrapd::server::http {
namespace {

struct FreeSsl {
  void operator()(SSL* ssl) const { SSL_free(ssl); }
};
using Session = std::unique_ptr<SSL, FreeSsl>;

int clamped(std::size_t size) {
  return static_cast<int>(std::min<std::size_t>(size, std::numeric_limits<int>::max()));
}

/// Counts the records that a client sends beside its data. Without a limit, they would keep the
/// reading thread busy for ever: OpenSSL answers a KeyUpdate, or a renegotiation, and reads on.
class Records {
 public:
  /// So many may come until the handshake is done, and so many that are no data after it.
  static constexpr int kMostInHandshake = 64;
  static constexpr int kMostBesideData = 16;

  void count(bool open, bool data) {
    int& of = open ? beside_data_ : in_handshake_;
    if (!open || !data) ++of;
  }
  [[nodiscard]] bool too_many() const {
    return in_handshake_ > kMostInHandshake || beside_data_ > kMostBesideData;
  }

 private:
  int in_handshake_ = 0;
  int beside_data_ = 0;
};

class TlsTransport final : public Transport {
 public:
  TlsTransport(int socket, Session session) : Transport(socket), session_(std::move(session)) {
    BIO* bytes = BIO_new(bio_method());
    BIO_set_data(bytes, this);
    BIO_set_init(bytes, 1);
    SSL_set_bio(session_.get(), bytes, bytes);
    SSL_set_msg_callback(session_.get(), count_record);
    SSL_set_msg_callback_arg(session_.get(), &records_);
    SSL_set_accept_state(session_.get());
  }

  [[nodiscard]] bool is_open() const override { return SSL_is_init_finished(session_.get()) == 1; }
  bool handshake() override {
    begin_step();
    const std::int64_t done = result_of(SSL_do_handshake(session_.get()));
    return done > 0 || done == kAgain;
  }
  std::int64_t receive(char* data, std::size_t size) override {
    begin_step();
    return result_of(SSL_read(session_.get(), data, clamped(size)));
  }
  std::int64_t send(std::string_view bytes) override {
    begin_step();
    return result_of(SSL_write(session_.get(), bytes.data(), clamped(bytes.size())));
  }
  [[nodiscard]] short awaits(short wanted) const override {
    if (wants_ == SSL_ERROR_WANT_READ) return POLLIN;
    if (wants_ == SSL_ERROR_WANT_WRITE) return POLLOUT;
    return wanted;
  }
  void end() override {
    begin_step();
    if (!broken_ && SSL_is_init_finished(session_.get())) SSL_shutdown(session_.get());
    Transport::end();
  }

 private:
  static constexpr std::size_t kMostInAStep = std::size_t{64} * 1024;

  static BIO_METHOD* bio_method();
  static int bio_read(BIO* bio, char* data, int size);
  static int bio_write(BIO* bio, const char* data, int size);
  static long bio_control(BIO*, int command, long, void*) { return command == BIO_CTRL_FLUSH; }
  // NOLINTNEXTLINE(readability-function-size): the parameters are those of OpenSSL's callback
  static void count_record(int sent, int, int type, const void* bytes, size_t, SSL* ssl, void* to);

  void begin_step() {
    ERR_clear_error();
    left_in_step_ = kMostInAStep;
  }
  std::int64_t result_of(int count) {
    wants_ = count > 0 ? SSL_ERROR_NONE : SSL_get_error(session_.get(), count);
    if (count > 0) return count;
    if (wants_ == SSL_ERROR_ZERO_RETURN) return 0;
    const bool waits = wants_ == SSL_ERROR_WANT_READ || wants_ == SSL_ERROR_WANT_WRITE;
    if (waits && !records_.too_many()) return kAgain;
    broken_ = true;
    return kBroken;
  }

  Records records_;
  std::size_t left_in_step_ = 0;  // bytes until OpenSSL must come back to us
  int wants_ = SSL_ERROR_NONE;
  bool broken_ = false;
  Session session_;  // last: it uses the others
};

/// The type of a record is in its header, within TLS 1.3 in its last byte.
// NOLINTNEXTLINE(readability-function-size): the parameters are those of OpenSSL's callback
void TlsTransport::count_record(int sent, int, int type, const void* bytes, size_t, SSL* ssl,
                                void* to) {
  if (sent != 0 || (type != SSL3_RT_HEADER && type != SSL3_RT_INNER_CONTENT_TYPE)) return;
  const bool data = *static_cast<const unsigned char*>(bytes) == SSL3_RT_APPLICATION_DATA;
  static_cast<Records*>(to)->count(SSL_is_init_finished(ssl) == 1, data);
}

BIO_METHOD* TlsTransport::bio_method() {
  static BIO_METHOD* const method = [] {
    BIO_METHOD* made = BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "client");
    BIO_meth_set_read(made, bio_read);
    BIO_meth_set_write(made, bio_write);
    BIO_meth_set_ctrl(made, bio_control);
    return made;
  }();
  return method;
}

/// Returns kAgain after a while, so that a client that never stops is only one among many. Fails
/// for a client that sends too many records without data.
int TlsTransport::bio_read(BIO* bio, char* data, int size) {
  auto& self = *static_cast<TlsTransport*>(BIO_get_data(bio));
  BIO_clear_retry_flags(bio);
  if (self.records_.too_many()) return -1;
  const std::size_t most = std::min(static_cast<std::size_t>(size), self.left_in_step_);
  const std::int64_t got = most == 0 ? kAgain : self.Transport::receive(data, most);
  if (got == kAgain) BIO_set_retry_read(bio);
  if (got > 0) self.left_in_step_ -= static_cast<std::size_t>(got);
  return static_cast<int>(std::max<std::int64_t>(got, -1));
}

int TlsTransport::bio_write(BIO* bio, const char* data, int size) {
  auto& self = *static_cast<TlsTransport*>(BIO_get_data(bio));
  BIO_clear_retry_flags(bio);
  const std::int64_t sent = self.Transport::send({data, static_cast<std::size_t>(size)});
  if (sent == kAgain) BIO_set_retry_write(bio);
  return static_cast<int>(std::max<std::int64_t>(sent, -1));
}

/// The first error of OpenSSL; later ones follow from it.
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

/// Asks for no pass phrase, as a server starts without a terminal.
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

TlsHandshakePool::TlsHandshakePool(int threads, std::function<void(Client)> back)
    : back_(std::move(back)) {
  threads_.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i)
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
}

void TlsHandshakePool::handshake(Client client) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(client));
  }
  arrived_.notify_one();
}

void TlsHandshakePool::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (arrived_.wait(lock, stop, [&] { return !waiting_.empty(); }) && !stop.stop_requested()) {
    Client client = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    if (client.transport->handshake()) back_(std::move(client));
    lock.lock();
  }
}

}  // namespace unwrapd::server::http
