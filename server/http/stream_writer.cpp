#include "server/http/stream_writer.hpp"

#include <poll.h>

#include <array>
#include <charconv>
#include <exception>
#include <utility>

#include "server/base/trace.hpp"

namespace unwrapd::server::http {
namespace {

constexpr int kLookMs = 250;       // how late a ping may be, or a slow client be noticed
constexpr int kPiecesInARow = 16;  // for one client, before the others get theirs
constexpr std::string_view kLastChunk = "0\r\n\r\n";

/// Frames bytes as a chunk (RFC 9112, section 7.1) if the stream is chunked.
std::string framed(std::string_view bytes, const OpenStream& open) {
  if (!open.chunked) return std::string(bytes);
  std::array<char, 16> size{};
  const auto [end, error] = std::to_chars(size.data(), size.data() + size.size(), bytes.size(), 16);
  return std::string(size.data(), end).append("\r\n").append(bytes).append("\r\n");
}

}  // namespace

StreamWriter::StreamWriter(Uses uses, const ConnectionLimits& limits,
                           std::chrono::milliseconds ping)
    : uses_(std::move(uses)), limits_(limits), ping_(ping), thread_([this] { work(); }) {}

void StreamWriter::take(Client client, OpenStream stream) {
  client.received.shrink_to_fit();
  {
    const std::lock_guard lock(mutex_);
    arrived_.emplace_back(std::move(client), std::move(stream));
  }
  uses_.news->ring();
}

void StreamWriter::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  uses_.news->ring();
  thread_.join();
}

void StreamWriter::work() {
  epoll_.add(uses_.news->descriptor(), POLLIN);
  const auto stopped = [this] {
    const std::lock_guard lock(mutex_);
    return stopped_;
  };
  while (!stopped()) turn(more_ ? 0 : streams_.empty() ? -1 : kLookMs);
  while (!streams_.empty()) finish(streams_.begin(), false);
}

void StreamWriter::turn(int patience_ms) {
  bool news = std::exchange(more_, false);
  for (const epoll_event& event : epoll_.wait(patience_ms)) {
    if (event.data.fd == uses_.news->descriptor())
      news = true;
    else
      attend(event.data.fd, event.events);
  }
  if (news) {  // after the events: their sockets may belong to other clients from now on
    uses_.news->answer();
    admit();
    go_on_all();
  }
  const auto now = Clock::now();
  if (now < next_look_) return;
  next_look_ = now + std::chrono::milliseconds(kLookMs);
  look_after(now);
}

void StreamWriter::attend(int descriptor, unsigned events) {
  const auto at = streams_.find(descriptor);
  if (at == streams_.end()) return;
  if ((events & (EPOLLERR | EPOLLHUP | EPOLLRDHUP)) != 0) return finish(at, false);
  Stream& stream = at->second;
  if (stream.waiting_since) stream.kept_waiting += Clock::now() - *stream.waiting_since;
  stream.waiting_since.reset();
  epoll_.change(descriptor, POLLRDHUP);
  go_on(at);
}

void StreamWriter::admit() {
  std::vector<std::pair<Client, OpenStream>> arrived;
  {
    const std::lock_guard lock(mutex_);
    arrived.swap(arrived_);
  }
  for (auto& [client, open] : arrived) {
    const int socket = client.transport->socket();
    streams_.try_emplace(socket, Stream{.client = std::move(client), .open = std::move(open)});
    epoll_.add(socket, POLLRDHUP);
  }
}

void StreamWriter::go_on_all() {
  for (auto at = streams_.begin(); at != streams_.end();) go_on(at++);
}

void StreamWriter::go_on(Streams::iterator at) {
  Stream& stream = at->second;
  for (int i = 0; i < kPiecesInARow; ++i) {
    if (stream.waiting_since) return;
    if (stream.unsent.empty() && stream.ended) return finish(at, !stream.open.last);
    const Progress progress = send_next(stream);
    if (progress == Progress::none) return;
    if (progress == Progress::failed) return finish(at, false);
  }
  more_ = true;
}

/// The unsent bytes, or else the next piece of the body.
StreamWriter::Progress StreamWriter::send_next(Stream& stream) const {
  try {
    if (stream.unsent.empty()) fetch(stream);
    if (stream.unsent.empty() && !stream.ended) return Progress::none;
    return send_unsent(stream) ? Progress::some : Progress::failed;
  } catch (const std::exception&) {  // there is no memory for it
    return Progress::failed;
  }
}

void StreamWriter::fetch(Stream& stream) {
  const StreamPiece piece = stream.open.body.next();
  if (!piece.bytes.empty()) stream.unsent = framed(piece.bytes, stream.open);
  if (piece.end && stream.open.chunked) stream.unsent += kLastChunk;
  stream.ended = piece.end;
}

/// Sends as much as the client takes now. False when it has gone.
bool StreamWriter::send_unsent(Stream& stream) const {
  std::string_view left = stream.unsent;
  while (!left.empty()) {
    const std::int64_t sent = stream.client.transport->send(left);
    if (sent == Transport::kAgain) break;
    if (sent <= 0) return false;
    left.remove_prefix(static_cast<std::size_t>(sent));
    stream.sent_bytes += sent;
    stream.last_sent = Clock::now();
  }
  stream.unsent = std::string(left);  // and not the memory of what is out
  if (stream.unsent.empty()) return true;
  stream.waiting_since = Clock::now();
  const Transport& transport = *stream.client.transport;
  const auto awaited = static_cast<unsigned short>(transport.awaits(POLLOUT));
  epoll_.change(transport.socket(), static_cast<short>(awaited | POLLRDHUP));
  return true;
}

void StreamWriter::look_after(Clock::time_point now) {
  for (auto at = streams_.begin(); at != streams_.end();) {
    const auto here = at++;
    Stream& stream = here->second;
    if (stream.waiting_since) {
      if (is_too_slow(stream, now)) finish(here, false);
    } else if (now - stream.last_sent >= ping_) {
      stream.unsent = framed(stream.open.body.ping, stream.open);
      go_on(here);
    }
  }
}

/// Whether a client takes nothing in time, or is too slow on average: single bytes must not hold a
/// place.
bool StreamWriter::is_too_slow(const Stream& stream, Clock::time_point now) const {
  const std::chrono::duration<double> this_time = now - *stream.waiting_since;
  const std::chrono::duration<double> in_all = stream.kept_waiting + this_time;
  const double expected = in_all.count() * static_cast<double>(limits_.min_bytes_per_second);
  return this_time > limits_.write ||
         (in_all > limits_.rate_grace && static_cast<double>(stream.sent_bytes) < expected);
}

void StreamWriter::finish(Streams::iterator at, bool again) {
  Stream stream = std::move(at->second);
  epoll_.remove(at->first);
  streams_.erase(at);
  stream.open.body = {};  // gives its place up before anybody learns of the end
  Exchanged& done = stream.open.done;
  done.sent_bytes += stream.sent_bytes;
  done.seconds = std::chrono::duration<double>(Clock::now() - stream.open.began).count();
  {
    const TraceScope trace(stream.open.trace);
    uses_.observe(done);
  }
  uses_.back(std::move(stream.client), again);
}

}  // namespace unwrapd::server::http
