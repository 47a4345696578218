#pragma once
// A worker process at work on a job. When the stop token says so it gets SIGTERM and, should it not
// end then, SIGKILL.

#include <chrono>
#include <functional>
#include <optional>
#include <stop_token>
#include <string_view>

#include "server/work/started_worker.hpp"

namespace unwrapd::server::work {

/// How a worker process is stopped.
struct Stopping {
  std::stop_token stop;
  std::chrono::milliseconds grace;     ///< between SIGTERM and SIGKILL
  std::function<void()> on_kill = {};  ///< called at SIGKILL
};

class WorkerProcess {
 public:
  /// Throws Error{internal} when too many files are open.
  WorkerProcess(StartedWorker worker, Stopping stopping);
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;
  ~WorkerProcess();

  /// Sends everything. When the worker has gone, ends like reap().
  void send(std::string_view bytes);
  /// Fills the memory; false when the worker has gone.
  bool receive(char* data, std::size_t size);

  /// The worker, which has answered: it may have another job. None if it was told to stop.
  [[nodiscard]] std::optional<StartedWorker> release();

  /// The worker has gone without an answer: throws Error{cancelled} when it was stopped, Error
  /// {time_limit} when its processor time ran out, else WorkerCrashed, saying how it ended.
  [[noreturn]] void reap();

 private:
  void ask_to_stop();
  void kill_when_due();
  [[nodiscard]] int patience_ms() const;
  void await(short events);

  StartedWorker worker_;
  const Stopping stopping_;
  const int stopped_;  // an eventfd: readable once a stop was requested
  std::optional<std::chrono::steady_clock::time_point> kill_at_;  // set by SIGTERM
  bool killed_ = false;
  std::optional<std::stop_callback<std::function<void()>>> on_stop_;
};

}  // namespace unwrapd::server::work
