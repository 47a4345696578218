#pragma once
// Worker processes that wait for the jobs to come, started, given their limits and locked in
// (sandbox.hpp): a job need not wait until its own has found its libraries. Each is for one job, or
// for the jobs of one mesh and owner, one after the other: somebody tries options, or drags a
// slider.

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "server/work/started_worker.hpp"

namespace unwrapd::server::work {

/// Thread-safe. All processes are started by one thread of its own: they die with that thread, and
/// those that ask for them come and go.
class SpareWorkers {
 public:
  /// Keeps count processes that start() makes.
  SpareWorkers(int count, std::function<StartedWorker()> start);
  SpareWorkers(const SpareWorkers&) = delete;
  SpareWorkers& operator=(const SpareWorkers&) = delete;
  ~SpareWorkers() = default;

  /// The one that has waited longest, if there is one; another takes its place at once. It may
  /// have ended while it waited.
  [[nodiscard]] std::optional<StartedWorker> take();

  /// One that has done a job of this mesh, and remembers what it has computed.
  [[nodiscard]] std::optional<StartedWorker> take_back(const std::string& mesh);
  /// Has a process that has done a job of a mesh wait for another one, for half a minute. It ends
  /// where the mesh is new here (most are sent once), the job was slow, or the process is old,
  /// large, or was started by another thread.
  void give_back(const std::string& mesh, StartedWorker worker,
                 std::chrono::steady_clock::duration job);

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Returned {
    std::string mesh;
    StartedWorker worker;
    Time until;
  };

  bool note_mesh(const std::string& mesh);
  void end_late(std::unique_lock<std::mutex>& lock);
  void keep(const std::stop_token& stop);
  [[nodiscard]] std::optional<StartedWorker> started() const;

  const std::size_t count_;
  const std::function<StartedWorker()> start_;
  std::mutex mutex_;
  std::condition_variable_any wanted_;
  bool has_failed_ = false;  // to start one; tried again when one is asked for
  std::deque<StartedWorker> spares_;
  std::list<Returned> returned_;   // the first to end first
  std::deque<std::string> known_;  // meshes of the last jobs
  bool has_returned_ = false;      // one more, of whose end keep() does not know
  std::jthread keeping_;
};

}  // namespace unwrapd::server::work
