#pragma once
// A worker process at the other end of a socket. When the stop token says so it gets SIGTERM and,
// should it not end then, SIGKILL; it never outlives this object.

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

namespace unwrapd::server {

/// How a worker process is stopped.
struct Stopping {
  std::stop_token stop;
  std::chrono::milliseconds grace;     ///< between SIGTERM and SIGKILL
  std::function<void()> on_kill = {};  ///< called at SIGKILL
};

class WorkerProcess {
 public:
  /// Starts program --job-worker with an empty environment. Throws Error{internal} when it cannot.
  WorkerProcess(const std::string& program, Stopping stopping);
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;
  ~WorkerProcess();

  /// Sends everything. When the worker has gone, ends like reap().
  void send(std::string_view bytes);
  /// Fills the memory; false when the worker has gone.
  bool receive(char* data, std::size_t size);

  /// The worker has gone without an answer: throws Error{cancelled} when it was stopped, Error
  /// {time_limit} when its processor time ran out, else WorkerCrashed, saying how it ended.
  [[noreturn]] void reap();

 private:
  void ask_to_stop();
  void kill_when_due();
  [[nodiscard]] int patience_ms() const;
  void await(short events);

  const Stopping stopping_;
  int socket_ = -1;
  int stopped_ = -1;  // an eventfd: readable once a stop was requested
  pid_t process_ = -1;
  std::optional<std::chrono::steady_clock::time_point> kill_at_;  // set by SIGTERM
  bool killed_ = false;
  std::optional<std::stop_callback<std::function<void()>>> on_stop_;
};

}  // namespace unwrapd::server
