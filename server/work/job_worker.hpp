#pragma once
// The worker process's side of --isolate: unwrapd started again with --job-worker as its only
// argument and a socket as its standard input. One job or rendering, then it ends.

#include <optional>
#include <string>

#include "server/work/worker_functions.hpp"

namespace unwrapd::server::work {

inline constexpr const char* kWorkerFlag = "--job-worker";

[[nodiscard]] bool is_job_worker(int argc, const char* const* argv);

/// Locks the process in, takes the job, does it. Returns the exit code.
int run_job_worker(const WorkerFunctions& functions);

/// What the server tells its worker of a job.
struct WorkerTask {
  api::Limits limits;
  std::int64_t memory_bytes = 0;
  double queue_ms = 0;
  double elapsed_ms = 0;                    ///< since the job began
  std::optional<Rendering> rendering = {};  ///< what to make of it; none: to run it
};

std::string pack_task(const WorkerTask& task, const store::JobRecord& job);

}  // namespace unwrapd::server::work
