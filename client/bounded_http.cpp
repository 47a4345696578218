#include "client/bounded_http.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace unwrapd::client {
namespace {

constexpr std::size_t kMostLine = 8192;
constexpr std::size_t kMostStatusLine = 512;
constexpr std::size_t kMostHead = 65'536;

class HeadStream : public httplib::Stream {
 public:
  HeadStream(int socket, int patience_ms) : socket_(socket), patience_ms_(patience_ms) {}

  bool is_readable() const override { return next_ < filled_ || await(POLLIN); }
  bool is_writable() const override { return await(POLLOUT); }
  int socket() const override { return socket_; }
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

  ssize_t write(const char* from, std::size_t size) override {
    if (!await(POLLOUT)) return -1;
    return retried([&] { return ::send(socket_, from, size, MSG_NOSIGNAL); });
  }

 private:
  template <class Call>
  static ssize_t retried(Call&& call) {
    ssize_t count = call();
    while (count < 0 && errno == EINTR) count = call();
    return count;
  }

  [[nodiscard]] bool await(short events) const {
    pollfd waiting{socket_, events, 0};
    return retried([&] { return ssize_t{::poll(&waiting, 1, patience_ms_)}; }) > 0;
  }

  ssize_t receive() {
    if (!await(POLLIN)) return -1;
    const ssize_t count = retried([&] { return ::recv(socket_, block_.data(), block_.size(), 0); });
    next_ = 0;
    filled_ = static_cast<std::size_t>(std::max<ssize_t>(count, 0));
    return head_.takes({block_.data(), filled_}) ? count : -1;
  }

  const int socket_;
  const int patience_ms_;
  AnswerHead head_;
  std::array<char, 4096> block_{};
  std::size_t next_ = 0;
  std::size_t filled_ = 0;
};

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
  HeadStream stream(socket.sock, static_cast<int>(1000 * read_timeout_sec_));
  return callback(stream);
}

}  // namespace unwrapd::client
