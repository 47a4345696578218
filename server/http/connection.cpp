#include "server/http/connection.hpp"

#include <linux/sockios.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <utility>

namespace unwrapd::server::http {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kReadBytes = std::size_t{64} * 1024;
constexpr std::size_t kMaxChunkLine = 256;  // a chunk's size with its extensions
constexpr int kMaxTrailers = 32;
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
constexpr std::chrono::seconds kLingerTime{10};
constexpr milliseconds kLingerSilence{2'000};

/// The ready events of a descriptor; 0 when none came in time, or stop (>= 0) became readable.
short wait_for(int descriptor, short events, int stop, milliseconds patience) {
  std::array<pollfd, 2> polled = {pollfd{descriptor, events, 0}, pollfd{stop, POLLIN, 0}};
  const Clock::time_point until = Clock::now() + patience;
  while (true) {
    const auto left = std::chrono::ceil<milliseconds>(until - Clock::now()).count();
    const int timeout = static_cast<int>(std::max<std::int64_t>(left, 0));
    const int ready = ::poll(polled.data(), stop >= 0 ? 2 : 1, timeout);
    if (ready < 0 && errno == EINTR) continue;
    return ready > 0 ? polled[0].revents : short{0};
  }
}

/// Bytes that wait in the kernel for the client.
int unsent_bytes(int socket) {
  int bytes = 0;
  return ::ioctl(socket, SIOCOUTQ, &bytes) == 0 ? bytes : 0;
}

/// Checks a chunk extension: it is empty, or begins with a semicolon and has no control characters,
/// which others may take for the end of the line.
bool is_chunk_extension(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return text.empty();
  const bool plain = std::ranges::none_of(
      text, [](char c) { return (c >= 0 && c < ' ' && c != '\t') || c == '\x7f'; });
  return text[first] == ';' && plain;
}

}  // namespace

Connection::Connection(Client client, int stop, const ConnectionLimits& limits)
    : client_(std::move(client)), stop_(stop), limits_(limits) {}

Connection::~Connection() {
  if (client_.transport) linger();
}

Client Connection::release() {
  buffer_.erase(0, used_);
  return std::move(client_);
}

bool Connection::has_next() const { return buffer_.find("\r\n\r\n", used_) != std::string::npos; }

/// Discards raw bytes, inside TLS or not.
void Connection::linger() const {
  client_.transport->end();
  const Waiting among(limits_.pressure.get());
  const Clock::time_point until = Clock::now() + kLingerTime;
  std::array<char, kReadBytes> waste;
  while (!body_done_ && !among.many() && Clock::now() < until) {
    if (wait_for(socket(), POLLIN, stop_, kLingerSilence) == 0) return;
    if (::recv(socket(), waste.data(), waste.size(), 0) <= 0) return;
  }
}

/// Appends what the client sends next to buffer_. False when nothing comes.
bool Connection::fill(milliseconds patience) {
  const Clock::time_point until = Clock::now() + patience;
  const std::size_t size = buffer_.size();
  buffer_.resize(size + kReadBytes);
  std::int64_t got = client_.transport->receive(buffer_.data() + size, kReadBytes);
  while (got == Transport::kAgain) {
    const auto left = std::chrono::ceil<milliseconds>(until - Clock::now());
    if (wait_for(socket(), client_.transport->awaits(POLLIN), -1, left) == 0) break;
    got = client_.transport->receive(buffer_.data() + size, kReadBytes);
  }
  buffer_.resize(size + static_cast<std::size_t>(std::max<std::int64_t>(got, 0)));
  return got > 0;
}

bool Connection::next_request() {
  buffer_.erase(0, used_);
  used_ = 0;
  head_end_ = 0;
  if (buffer_.empty() && wait_for(socket(), POLLIN, stop_, limits_.idle) == 0) return false;
  const Clock::time_point until = Clock::now() + limits_.head;
  std::size_t end = buffer_.find("\r\n\r\n");
  while (end == std::string::npos) {
    if (buffer_.size() > kMaxHeadBytes)
      throw Error(ErrorCode::headers_too_large, "The header is longer than 32 KiB; shorten it.");
    const auto left = std::chrono::ceil<milliseconds>(until - Clock::now());
    const bool more = left.count() > 0 && fill(left);
    if (!more && Clock::now() >= until)
      throw Error(ErrorCode::request_timeout, "The header did not arrive in time; send it faster.");
    if (!more) return false;  // the client has gone
    end = buffer_.find("\r\n\r\n");
  }
  head_end_ = end + 4;
  if (head_end_ > kMaxHeadBytes)
    throw Error(ErrorCode::headers_too_large, "The header is longer than 32 KiB; shorten it.");
  framing_ = vet_head(std::string_view(buffer_).substr(0, head_end_));
  head_end_ -= static_cast<std::size_t>(simplify(buffer_, framing_));
  if (buffer_.size() > head_end_) framing_.awaits_continue = false;  // it did not wait
  left_ = framing_.content_length;
  body_done_ = !framing_.has_body();
  chunk_open_ = false;
  body_bytes_ = 0;
  sent_bytes_ = 0;
  kept_waiting_ = {};
  body_began_ = Clock::now();
  failure_.reset();
  return true;
}

std::int64_t Connection::read(char* data, std::size_t size) {
  return used_ < head_end_ ? read_head(data, size) : read_body(data, size);
}

std::int64_t Connection::read_head(char* data, std::size_t size) {
  const std::size_t count = std::min(size, head_end_ - used_);
  buffer_.copy(data, count, used_);
  used_ += count;
  return static_cast<std::int64_t>(count);
}

std::int64_t Connection::read_body(char* data, std::size_t size) {
  if (failure_) return -1;
  if (body_done_) return 0;
  if (framing_.chunked && left_ == 0 && !begin_chunk()) return failure_ ? -1 : 0;
  if (left_ > limits_.max_body_bytes - body_bytes_) {
    return fail(ErrorCode::body_too_large, "The body is larger than the " +
                                               std::to_string(limits_.max_body_bytes) +
                                               " bytes that this server accepts; send less.");
  }
  if (used_ == buffer_.size() && !fill_body()) return -1;
  const std::size_t here = std::min(size, buffer_.size() - used_);
  const std::int64_t count = std::min(static_cast<std::int64_t>(here), left_);
  buffer_.copy(data, static_cast<std::size_t>(count), used_);
  used_ += static_cast<std::size_t>(count);
  count_body(count);
  return count;
}

void Connection::count_body(std::int64_t bytes) {
  left_ -= bytes;
  body_bytes_ += bytes;
  if (!framing_.chunked && left_ == 0) body_done_ = true;
}

/// Reads up to the first byte of the next chunk. False at the end of the body, or on failure.
bool Connection::begin_chunk() {
  if (chunk_open_ && read_line() != "") {
    fail(ErrorCode::malformed_request, "A chunk is longer than its stated size; check the client.");
    return false;
  }
  const std::optional<std::string> line = read_line();
  if (!line) return false;
  std::uint32_t size = 0;
  const auto parsed = std::from_chars(line->data(), line->data() + line->size(), size, 16);
  const std::string_view rest(parsed.ptr, line->data() + line->size());
  if (parsed.ec != std::errc() || !is_chunk_extension(rest)) {
    fail(ErrorCode::malformed_request,
         "The size of a chunk is not a hex number; check the client.");
    return false;
  }
  left_ = size;
  chunk_open_ = true;
  return size > 0 || end_trailers();
}

/// Skips the trailers. Always false, as the body ends here.
bool Connection::end_trailers() {
  for (int i = 0; i <= kMaxTrailers; ++i) {
    const std::optional<std::string> line = read_line();
    if (!line) return false;
    if (line->empty()) {
      body_done_ = true;
      return false;
    }
    if (!is_trailer(*line)) {
      fail(ErrorCode::malformed_request,
           "A trailer is not of the form \"Name: value\"; send none.");
      return false;
    }
  }
  fail(ErrorCode::headers_too_large, "The body has too many trailer fields; send none.");
  return false;
}

/// A line of the body's framing, without its end.
std::optional<std::string> Connection::read_line() {
  std::size_t end = buffer_.find("\r\n", used_);
  while (end == std::string::npos) {
    if (buffer_.size() - used_ > kMaxChunkLine) {
      fail(ErrorCode::malformed_request, "A chunk does not begin with its size; check the client.");
      return std::nullopt;
    }
    if (!fill_body()) return std::nullopt;
    end = buffer_.find("\r\n", used_);
  }
  std::string line = buffer_.substr(used_, end - used_);
  used_ = end + 2;
  return line;
}

/// Receives more of the body.
bool Connection::fill_body() {
  if (std::exchange(framing_.awaits_continue, false)) write(kContinue);
  buffer_.erase(0, used_);
  used_ = 0;
  head_end_ = 0;
  const Waiting among(limits_.pressure.get());
  const bool many = among.many();
  const std::chrono::duration<double> elapsed = Clock::now() - body_began_;
  const double expected =
      elapsed.count() *
      static_cast<double>(many ? limits_.crowded_bytes_per_second : limits_.min_bytes_per_second);
  const bool slow = elapsed > (many ? limits_.crowded : limits_.rate_grace) &&
                    static_cast<double>(body_bytes_) < expected;
  if (!slow && fill(many ? limits_.crowded : limits_.read)) return true;
  fail(ErrorCode::request_timeout, "The body did not arrive in time; send it faster.");
  return false;
}

std::int64_t Connection::fail(ErrorCode code, const std::string& message) {
  failure_.emplace(code, message);
  return -1;
}

/// Those of the events that are ready. 0 when the client takes nothing in time, or is too slow on
/// average: single bytes must not hold a thread. An event stream without events is not slow.
short Connection::wait_to_send(short events) {
  const double expected = kept_waiting_.count() * static_cast<double>(limits_.min_bytes_per_second);
  if (kept_waiting_ > limits_.rate_grace && static_cast<double>(sent_bytes_) < expected) return 0;
  const Waiting among(limits_.pressure.get());
  const Clock::time_point began = Clock::now();
  int unsent = unsent_bytes(socket());
  short ready = 0;
  while (ready == 0 && Clock::now() - began < limits_.write) {
    ready = wait_for(socket(), events, -1, std::min(limits_.crowded, limits_.write));
    const int left = unsent_bytes(socket());
    if (ready == 0 && among.many() && left >= unsent) break;  // it takes nothing at all
    unsent = left;
  }
  kept_waiting_ += Clock::now() - began;
  return ready;
}

bool Connection::is_writable() {
  const short events = wait_to_send(POLLOUT | POLLRDHUP);
  return (events & POLLOUT) != 0 && (events & (POLLERR | POLLHUP | POLLRDHUP)) == 0;
}

bool Connection::has_left() const {
  pollfd polled{socket(), POLLRDHUP, 0};
  return ::poll(&polled, 1, 0) > 0;
}

std::int64_t Connection::write(std::string_view bytes) {
  std::int64_t sent = client_.transport->send(bytes);
  if (sent == Transport::kAgain) {
    const short awaits = client_.transport->awaits(POLLOUT);
    if ((wait_to_send(awaits) & awaits) == 0) return -1;
    sent = client_.transport->send(bytes);
  }
  if (sent == Transport::kAgain) return 0;
  if (sent < 0) return -1;
  sent_bytes_ += sent;
  return sent;
}

}  // namespace unwrapd::server::http
