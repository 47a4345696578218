#pragma once
// The start of a worker process: the one place that knows with what it begins.

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "server/work/sandbox.hpp"

namespace unwrapd::server::work {

/// A worker process (job_worker.hpp) and our end of the socket to it. It never outlives this
/// object, nor the thread that has started it (sandbox.hpp).
class StartedWorker {
 public:
  /// Starts program --job-worker with none of our environment, and tells it its limits. Throws
  /// Error{internal} when it cannot.
  StartedWorker(const std::string& program, const SandboxLimits& limits);
  StartedWorker(StartedWorker&& other) noexcept;
  StartedWorker& operator=(StartedWorker&&) = delete;
  ~StartedWorker();

  [[nodiscard]] int socket() const { return socket_; }
  [[nodiscard]] pid_t process() const { return process_; }

  /// Whether the thread that has started it lives as long as the server.
  [[nodiscard]] bool is_lasting() const { return is_lasting_; }
  void set_lasting() { is_lasting_ = true; }

  /// The memory that it holds, in bytes; none where that cannot be told.
  [[nodiscard]] std::optional<std::int64_t> held_bytes() const;

  /// The time of the jobs that it has done.
  [[nodiscard]] std::chrono::steady_clock::duration worked() const { return worked_; }
  void count(std::chrono::steady_clock::duration job) { worked_ += job; }

  /// Ends the process if it has not ended yet. Returns how it ended, as wait(2) tells it.
  int end();

 private:
  int socket_ = -1;
  pid_t process_ = -1;
  bool is_lasting_ = false;
  std::chrono::steady_clock::duration worked_{};
};

}  // namespace unwrapd::server::work
