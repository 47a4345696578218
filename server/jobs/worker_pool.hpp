#pragma once
// The threads that run jobs, one after another, in the order of the queue. Their priority is lower
// than that of threads that answer, which would otherwise wait for their turns on a full machine. A
// job that ran when a server died is suspected, and runs in a process of its own where that is
// possible. Only if it ends three processes, too, it fails as `poison`.
//
// A job that does not stop when asked is ended by force after its grace: its process is killed. A
// thread cannot be killed, so the job is given up and another thread takes the place of its thread,
// which ends when its work does. At most as many threads are replaced as there are workers.

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
#include "server/blobs/blob_store.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/store/quota_reservations.hpp"
#include "server/store/stored_input.hpp"
#include "server/work/job_process.hpp"
#include "server/work/job_worker.hpp"

namespace unwrapd::server::jobs {

struct WorkerConfig {
  int workers = 1;
  int threads = 1;                                   ///< for each worker's job
  SharedCache* core = nullptr;                       ///< that their jobs share; outlives the pool
  store::QuotaReservations* reservations = nullptr;  ///< of their results; outlives the pool
  /// Bytes that an owner may store; 0: any.
  std::function<std::int64_t(const std::string& owner)> most_bytes;
  work::Isolation isolation = {};  ///< its grace holds for threads, too
  work::WorkerFunctions functions = {};
  /// Called for each job that was ended by force: "killed" or "given_up".
  std::function<void(std::string_view how)> on_force = [](std::string_view) {};
};

class WorkerPool {
 public:
  /// Starts at once; the destructor waits until the queue is closed and the running jobs have
  /// ended.
  WorkerPool(JobQueue& queue, blobs::BlobStore& blobs, const api::Limits& limits, const Log& log,
             const WorkerConfig& config);
  ~WorkerPool();

  /// Threads that still run a job that was given up.
  [[nodiscard]] int lost() const;
  /// Whether a thread is left that takes jobs.
  [[nodiscard]] bool are_left() const;

 private:
  struct Means;
  /// What a thread does after a job.
  enum class Then { next_job, leave };
  using Threads = std::list<std::jthread>;

  void begin_thread();
  void work();
  Then work_on(RunningJob& job, Executor& executor);
  void help_with(HelpedJob& helped);
  [[nodiscard]] bool is_apart(const store::JobRecord& job) const;
  void give_up(RunningJob& job, store::QuotaReservation& reservation);
  void lose_thread(const RunningJob& job);
  Then come_back(const RunningJob& job);
  store::JobOutcome attempt(const RunningJob& job, const Means& means);
  std::string run_patiently(const RunningJob& job, const Means& means);
  [[nodiscard]] store::LoadedInput load(const RunningJob& job) const;
  std::string run(const RunningJob& job, const Means& means);

  JobQueue& queue_;
  blobs::BlobStore& blobs_;
  const api::Limits& limits_;
  const Log& log_;
  const WorkerConfig config_;
  mutable std::mutex mutex_;
  int lost_ = 0;      // threads
  int replaced_ = 0;  // of those, by another thread
  Threads threads_;
  Threads ended_;  // to be joined
};

}  // namespace unwrapd::server::jobs
