#pragma once
// The side of the worker process in --isolate: unwrapd started again with --job-worker as its only
// argument and a socket as its standard input. It does one job or rendering, then it ends; or it
// does further jobs of the same mesh, with what it remembers of it.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/work/rendering.hpp"
#include "server/work/run_job.hpp"

namespace unwrapd::server::work {

/// The work on meshes that a worker process does. Tests replace the functions.
struct WorkerFunctions {
  std::function<std::string(const JobTask&, const asset::Input&, JobOutput&, const api::Limits&,
                            Executor&)>
      run = run_job;
  std::function<std::string(const Rendering&, const RenderingInput&, const api::Limits&)> draw =
      render;
  std::string program = {};  ///< started with --job-worker for this work; empty: none
};

/// What a worker process remembers of a mesh between its jobs at most, beside the memory of a job.
inline constexpr std::int64_t kKeptForMesh = std::int64_t{128} << 20;

inline constexpr const char* kWorkerFlag = "--job-worker";

[[nodiscard]] bool is_job_worker(int argc, const char* const* argv);

/// Enters the sandbox, receives the job, does it. Returns the exit code.
int run_job_worker(const WorkerFunctions& functions);

/// What the server sends to its worker, beside the record and the input.
struct WorkerTask {
  api::Limits limits;
  std::int64_t memory_bytes = 0;
  double queue_ms = 0;
  double elapsed_ms = 0;                    ///< since the job began
  std::optional<Rendering> rendering = {};  ///< the file to make; none: run the job
  bool is_shared = false;                   ///< others work on the job, too
  bool is_helper = false;                   ///< this process is one of them, and answers nothing
};

std::string pack_task(const WorkerTask& task, const store::JobRecord& job);

}  // namespace unwrapd::server::work
