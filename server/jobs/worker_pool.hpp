#pragma once
// The threads that do the work: each takes the job whose turn it is and runs it, one after another.
// They are nice to the threads that answer, which would otherwise wait for their turns on a full
// machine. A job that was at work when a server died is suspected, and tried in a process of its
// own where that can be had: only if it ends that, too, three times, is it to blame (`poison`).
//
// A job that was told to stop and goes on is ended by force when its grace is over: its process is
// killed. A thread cannot be killed: the job is given up, another thread takes the worker's place,
// and the lost one ends where its work does. Of these there are no more than there are workers.

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "api/limits.hpp"
#include "core/base/executor.hpp"
#include "core/base/shared_cache.hpp"
#include "server/base/log.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/store/blob_store.hpp"
#include "server/store/quota_reservations.hpp"
#include "server/work/job_process.hpp"
#include "server/work/worker_functions.hpp"

namespace unwrapd::server::jobs {

struct WorkerConfig {
  int workers = 1;
  int threads = 1;                                   ///< for each worker's job
  SharedCache* core = nullptr;                       ///< that their jobs share; outlives the pool
  store::QuotaReservations* reservations = nullptr;  ///< of their results; outlives the pool
  /// Bytes that an owner may have; 0: any.
  std::function<std::int64_t(const std::string& owner)> most_bytes;
  work::Isolation isolation = {};  ///< its grace holds for threads, too
  work::WorkerFunctions functions = {};
  /// Told of each job that was ended by force: "killed" or "given_up".
  std::function<void(std::string_view how)> on_force = [](std::string_view) {};
};

class WorkerPool {
 public:
  /// Starts at once; ends when the queue is closed and the jobs at hand are done.
  WorkerPool(JobQueue& queue, store::BlobStore& blobs, const api::Limits& limits, const Log& log,
             const WorkerConfig& config);
  ~WorkerPool();

  /// Threads that are still at work on a job that was given up.
  [[nodiscard]] int lost() const;
  /// Whether a thread is there that takes jobs.
  [[nodiscard]] bool are_left() const;

 private:
  /// What a job is run with.
  struct Means {
    Executor& executor;
    store::QuotaReservation& reservation;
  };
  /// What becomes of a thread when it is done with a job.
  enum class Then { next_job, leave };
  using Threads = std::list<std::jthread>;

  void begin_thread();
  void work();
  Then work_on(RunningJob& job, Executor& executor);
  [[nodiscard]] bool is_apart(const store::JobRecord& job) const;
  void give_up(RunningJob& job, store::QuotaReservation& reservation);
  void lose_thread(const RunningJob& job);
  Then come_back(const RunningJob& job);
  store::JobOutcome attempt(const RunningJob& job, const Means& means);
  std::string run_patiently(const RunningJob& job, const Means& means);
  std::string run(const RunningJob& job, const Means& means);

  JobQueue& queue_;
  store::BlobStore& blobs_;
  const api::Limits& limits_;
  const Log& log_;
  const WorkerConfig config_;
  mutable std::mutex mutex_;
  int lost_ = 0;      // threads
  int replaced_ = 0;  // of those, by another thread
  Threads threads_;
  Threads ended_;  // about to, and to be joined
};

}  // namespace unwrapd::server::jobs
