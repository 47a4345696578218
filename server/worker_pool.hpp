#pragma once
// The threads that do the work: each takes the oldest job and runs it, one after another. They are
// nice to the threads that answer, which would otherwise wait for their turns on a full machine.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "api/limits.hpp"
#include "core/executor.hpp"
#include "core/solver_core.hpp"
#include "server/blob_store.hpp"
#include "server/job_process.hpp"
#include "server/job_queue.hpp"
#include "server/log.hpp"

namespace unwrapd::server {

/// Calls late() once when it still exists after a time.
class Deadline {
 public:
  Deadline(std::chrono::seconds time, std::function<void()> late);

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watch_;  // last: it uses the others
};

struct WorkerConfig {
  int workers = 1;
  int threads = 1;             ///< for each worker's job
  SolverCore* core = nullptr;  ///< that their jobs share; outlives the pool
  Isolation isolation = {};
};

class WorkerPool {
 public:
  /// Starts at once; ends when the queue is closed and the jobs at hand are done.
  WorkerPool(JobQueue& queue, BlobStore& blobs, const api::Limits& limits, const Log& log,
             const WorkerConfig& config);

 private:
  void work(const WorkerConfig& config);
  void work_on(RunningJob& job, Executor& executor);
  JobOutcome attempt(const RunningJob& job, Executor& executor);
  std::string run_patiently(const RunningJob& job, Executor& executor);
  std::string run(const RunningJob& job, Executor& executor);

  JobQueue& queue_;
  BlobStore& blobs_;
  const api::Limits& limits_;
  const Log& log_;
  const Isolation isolation_;
  std::vector<std::jthread> threads_;
};

}  // namespace unwrapd::server
