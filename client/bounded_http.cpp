#include "client/bounded_http.hpp"

#include <openssl/ssl.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace unwrapd::client {
namespace {

constexpr std::size_t kMostLine = 8192;
constexpr std::size_t kMostStatusLine = 512;
constexpr std::size_t kMostHead = 65'536;

template <class Call>
ssize_t retried(Call&& call) {
  ssize_t count = call();
  while (count < 0 && errno == EINTR) count = call();
  return count;
}

/// A connected socket that is waited for at most so long.
struct PatientSocket {
  int socket;
  int patience_ms;

  [[nodiscard]] bool await(short events) const {
    pollfd waiting{socket, events, 0};
    return retried([&] { return ssize_t{::poll(&waiting, 1, patience_ms)}; }) > 0;
  }
};

class PlainBytes {
 public:
  explicit PlainBytes(PatientSocket socket) : socket_(socket) {}

  [[nodiscard]] const PatientSocket& socket() const { return socket_; }
  [[nodiscard]] bool has_pending() const { return false; }

  ssize_t receive(char* to, std::size_t size) {
    if (!socket_.await(POLLIN)) return -1;
    return retried([&] { return ::recv(socket_.socket, to, size, 0); });
  }
  ssize_t send(const char* from, std::size_t size) {
    if (!socket_.await(POLLOUT)) return -1;
    return retried([&] { return ::send(socket_.socket, from, size, MSG_NOSIGNAL); });
  }

 private:
  PatientSocket socket_;
};

class TlsBytes {
 public:
  TlsBytes(PatientSocket socket, SSL* tls) : socket_(socket), tls_(tls) {}

  [[nodiscard]] const PatientSocket& socket() const { return socket_; }
  [[nodiscard]] bool has_pending() const { return SSL_pending(tls_) > 0; }

  ssize_t receive(char* to, std::size_t size) {
    if (!has_pending() && !socket_.await(POLLIN)) return -1;
    return tried([&] { return SSL_read(tls_, to, static_cast<int>(size)); });
  }
  ssize_t send(const char* from, std::size_t size) {
    if (!socket_.await(POLLOUT)) return -1;
    return tried([&] { return SSL_write(tls_, from, static_cast<int>(std::min(size, kBlock))); });
  }

 private:
  static constexpr std::size_t kBlock = 65'536;
  static constexpr int kMostTries = 1000;  // records without data: handshakes, tickets

  /// 0 where the other side says that it has ended.
  template <class Call>
  ssize_t tried(Call&& call) {
    for (int k = 0; k < kMostTries; ++k) {
      const int count = call();
      if (count > 0) return count;
      const int error = SSL_get_error(tls_, count);
      if (error == SSL_ERROR_ZERO_RETURN) return 0;
      const bool waits = error == SSL_ERROR_WANT_READ || error == SSL_ERROR_WANT_WRITE;
      if (!waits || !socket_.await(error == SSL_ERROR_WANT_READ ? POLLIN : POLLOUT)) return -1;
    }
    return -1;
  }

  PatientSocket socket_;
  SSL* tls_;
};

template <class Bytes>
class HeadStream : public httplib::Stream {
 public:
  explicit HeadStream(Bytes bytes) : bytes_(bytes) {}

  bool is_readable() const override {
    return next_ < filled_ || bytes_.has_pending() || bytes_.socket().await(POLLIN);
  }
  bool is_writable() const override { return bytes_.socket().await(POLLOUT); }
  int socket() const override { return bytes_.socket().socket; }
  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip.clear(), port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip.clear(), port = 0; }

  ssize_t read(char* to, std::size_t size) override {
    if (next_ == filled_) {
      const ssize_t count = receive();
      if (count <= 0) return count;
    }
    const std::size_t count = std::min(size, filled_ - next_);
    std::copy_n(block_.data() + next_, count, to);
    next_ += count;
    return static_cast<ssize_t>(count);
  }

  ssize_t write(const char* from, std::size_t size) override { return bytes_.send(from, size); }

 private:
  ssize_t receive() {
    const ssize_t count = bytes_.receive(block_.data(), block_.size());
    next_ = 0;
    filled_ = static_cast<std::size_t>(std::max<ssize_t>(count, 0));
    return head_.takes({block_.data(), filled_}) ? count : -1;
  }

  Bytes bytes_;
  AnswerHead head_;
  std::array<char, 4096> block_{};
  std::size_t next_ = 0;
  std::size_t filled_ = 0;
};

int in_milliseconds(time_t seconds) { return static_cast<int>(1000 * seconds); }

}  // namespace

bool AnswerHead::ends_line() {
  if (line_.ends_with('\r')) line_.pop_back();
  if (line_.starts_with("HTTP/")) {
    is_interim_ = line_.find(" 100") != std::string::npos;
    if (line_.size() > kMostStatusLine) return false;
  }
  if (line_.empty()) is_over_ = !is_interim_;
  line_.clear();
  return true;
}

bool AnswerHead::takes(std::string_view bytes) {
  for (const char byte : bytes) {
    if (is_over_) return true;
    if (++size_ > kMostHead || line_.size() > kMostLine) return false;
    if (byte != '\n')
      line_ += byte;
    else if (!ends_line())
      return false;
  }
  return true;
}

bool BoundedHttp::process_socket(const Socket& socket,
                                 std::function<bool(httplib::Stream&)> callback) {
  HeadStream stream(PlainBytes({socket.sock, in_milliseconds(read_timeout_sec_)}));
  return callback(stream);
}

bool BoundedHttps::process_socket(const Socket& socket,
                                  std::function<bool(httplib::Stream&)> callback) {
  HeadStream stream(TlsBytes({socket.sock, in_milliseconds(read_timeout_sec_)}, socket.ssl));
  return callback(stream);
}

}  // namespace unwrapd::client
