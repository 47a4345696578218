#pragma once
// One client's socket: bytes in and out, each wait bounded. A Connection reads the head of a
// request, then its body without the framing: the reader of a body sees its end and its limit, not
// the sizes of chunks. The body is counted here, so that the limit holds for chunked bodies as
// well.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "server/http/http_head.hpp"
#include "server/http/transport.hpp"

namespace unwrapd::server::http {

/// Counts the threads of a server that wait for clients: for bytes of a body, or until an answer is
/// taken. Slow clients must not hold all of them: above a limit, more is asked of each client.
struct SlowClientPressure {
  int many = 0;  ///< above which there are too many
  std::atomic<int> waiting = 0;
};

/// Counts the calling thread among those that wait for clients.
class Waiting {
 public:
  explicit Waiting(SlowClientPressure* pressure) : pressure_(pressure) {
    if (pressure_ != nullptr) ++pressure_->waiting;
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;
  ~Waiting() {
    if (pressure_ != nullptr) --pressure_->waiting;
  }
  [[nodiscard]] bool many() const {
    return pressure_ != nullptr && pressure_->waiting > pressure_->many;
  }

 private:
  SlowClientPressure* const pressure_;
};

struct ConnectionLimits {
  std::int64_t max_body_bytes = 0;
  std::chrono::milliseconds idle{15'000};    ///< between two requests
  std::chrono::milliseconds head{10'000};    ///< from its first byte to the empty line
  std::chrono::milliseconds read{20'000};    ///< for the next bytes of a body
  std::chrono::milliseconds write{20'000};   ///< for the client to take more bytes
  std::int64_t min_bytes_per_second = 1024;  ///< of a body, and of an answer while we wait for it
  std::chrono::milliseconds rate_grace{20'000};       ///< until that counts
  std::shared_ptr<SlowClientPressure> pressure = {};  ///< of one server; none: never many
  std::chrono::milliseconds crowded{2'000};  ///< replaces read, write and rate_grace under pressure
  std::int64_t crowded_bytes_per_second = 16'384;  ///< of a body under pressure
};

class Connection {
 public:
  /// stop: a descriptor that becomes readable when the server stops; it ends idle waits.
  Connection(Client client, int stop, const ConnectionLimits& limits);
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  /// Closes. A body that was not read is discarded for a while, so that the answer still arrives.
  ~Connection();

  /// Waits for the next request and vets its head, which read() then returns first. False when the
  /// client has gone or nothing came in time. Throws what vet_head() throws.
  bool next_request();
  /// Whether the head of another request is here already.
  [[nodiscard]] bool has_next() const;
  /// Hands the client over, with what it has sent beyond the last request. Call nothing after it.
  [[nodiscard]] Client release();
  /// Reads bytes of the head, then of the body; 0 at the end of the body, -1 on failure().
  std::int64_t read(char* data, std::size_t size);
  /// Returns the number of bytes written; -1 when the client has gone or does not read.
  std::int64_t write(std::string_view bytes);
  /// Whether the client takes bytes now or in time, and is still there.
  [[nodiscard]] bool is_writable();
  /// Whether the client has closed its end, be it only for sending, or is lost.
  [[nodiscard]] bool has_left() const;

  [[nodiscard]] bool is_readable() const { return !body_done_; }
  /// Whether the current request has been handed out to its end: what follows is the next one.
  [[nodiscard]] bool is_read() const { return body_done_ && used_ >= head_end_; }
  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }
  [[nodiscard]] int socket() const { return client_.transport->socket(); }
  /// Its address.
  [[nodiscard]] const std::string& client() const { return client_.address; }
  /// Of the current request.
  [[nodiscard]] const Framing& framing() const { return framing_; }
  [[nodiscard]] std::int64_t max_body_bytes() const { return limits_.max_body_bytes; }
  /// Bytes of the current request's body, without framing.
  [[nodiscard]] std::int64_t body_bytes() const { return body_bytes_; }
  /// Bytes sent since the current request's head was vetted.
  [[nodiscard]] std::int64_t sent_bytes() const { return sent_bytes_; }

 private:
  bool fill(std::chrono::milliseconds patience);
  std::int64_t read_head(char* data, std::size_t size);
  std::int64_t read_body(char* data, std::size_t size);
  bool begin_chunk();
  std::optional<std::string> read_line();
  bool end_trailers();
  bool fill_body();
  void count_body(std::int64_t bytes);
  std::int64_t fail(ErrorCode code, const std::string& message);
  short wait_to_send(short events);
  void linger() const;

  Client client_;
  const int stop_;
  const ConnectionLimits limits_;
  std::string& buffer_ = client_.received;  // received, from used_ on not yet handed out
  std::size_t used_ = 0;
  std::size_t head_end_ = 0;  // of the current request, in buffer_
  Framing framing_;
  std::int64_t left_ = 0;  // of the body, or of the current chunk
  bool chunk_open_ = false;
  bool body_done_ = true;
  std::int64_t body_bytes_ = 0;
  std::int64_t sent_bytes_ = 0;
  std::chrono::steady_clock::time_point body_began_;
  std::chrono::duration<double> kept_waiting_{};  // by the client, while it took the answer
  std::optional<Error> failure_;
};

}  // namespace unwrapd::server::http
