#pragma once
// The threads that do the work: each takes the job whose turn it is and runs it, one after another.
// They are nice to the threads that answer, which would otherwise wait for their turns on a full
// machine. A job that was at work when a server died is suspected, and tried in a process of its
// own where that can be had: only if it ends that, too, three times, is it to blame (`poison`).

#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "api/limits.hpp"
#include "core/executor.hpp"
#include "core/solver_core.hpp"
#include "server/blob_store.hpp"
#include "server/claims.hpp"
#include "server/duties.hpp"
#include "server/job_process.hpp"
#include "server/job_queue.hpp"
#include "server/log.hpp"

namespace unwrapd::server {

struct WorkerConfig {
  int workers = 1;
  int threads = 1;             ///< for each worker's job
  SolverCore* core = nullptr;  ///< that their jobs share; outlives the pool
  Claims* claims = nullptr;    ///< of their results; outlives the pool
  /// Bytes that an owner may have; 0: any.
  std::function<std::int64_t(const std::string& owner)> most_bytes;
  Isolation isolation = {};
  Duties duties = {};
};

class WorkerPool {
 public:
  /// Starts at once; ends when the queue is closed and the jobs at hand are done.
  WorkerPool(JobQueue& queue, BlobStore& blobs, const api::Limits& limits, const Log& log,
             const WorkerConfig& config);

 private:
  /// What a job is run with.
  struct Means {
    Executor& executor;
    Claim& claim;
  };

  void work();
  void work_on(RunningJob& job, Executor& executor);
  JobOutcome attempt(const RunningJob& job, const Means& means);
  std::string run_patiently(const RunningJob& job, const Means& means);
  std::string run(const RunningJob& job, const Means& means);

  JobQueue& queue_;
  BlobStore& blobs_;
  const api::Limits& limits_;
  const Log& log_;
  const WorkerConfig config_;
  std::vector<std::jthread> threads_;
};

}  // namespace unwrapd::server
