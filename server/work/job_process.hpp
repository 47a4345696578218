#pragma once
// --isolate: a job, and each file made of it later, is processed in a process of its own without
// files or network and with bounded memory (sandbox.hpp), so that a crash costs only this job or
// request. A process may do further jobs of the same mesh and owner (spare_workers.hpp). Rejected:
// a process kept for other jobs (a crash, or a mesh that takes the process over, would reach the
// next job), and fork without exec (of a program with threads).

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <stop_token>
#include <string>

#include "api/limits.hpp"
#include "core/asset/asset.hpp"
#include "server/work/rendering.hpp"
#include "server/work/run_job.hpp"
#include "server/work/spare_workers.hpp"

namespace unwrapd::server::work {

/// The worker process ended without an answer.
class WorkerCrashed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Isolation {
  bool on = false;                                    ///< for all jobs
  bool possible = false;                              ///< for those that may have ended a server
  std::string why_not = {};                           ///< if it is not
  std::int64_t memory_bytes = std::int64_t{4} << 30;  ///< of a job
  int threads = 1;                                    ///< of a job
  std::chrono::seconds grace{5};                      ///< for a process that was told to stop
  std::string program = {};                           ///< what --job-worker starts
  std::function<void()> on_kill = {};         ///< called when one has not ended within its grace
  std::shared_ptr<SpareWorkers> spares = {};  ///< for the jobs to come
};

/// Throws Error{internal} when no worker process can be started and locked in on this machine.
void check_isolation(const Isolation& isolation);

/// Why jobs cannot have processes here, in words; empty when they can.
std::string why_not(const Isolation& isolation);

/// As many processes as are given, for jobs and files to come under these limits.
std::shared_ptr<SpareWorkers> spare_workers(int count, const api::Limits& limits,
                                            const Isolation& isolation);

/// run_job() in a process of its own. Throws what that throws, and WorkerCrashed; of an exception
/// that is no Error, its text as a std::runtime_error.
std::string run_job_isolated(const JobTask& task, const asset::Input& input, JobOutput& output,
                             const api::Limits& limits, const Isolation& isolation);

/// The same for a process that helps with a job that another one answers for, at the task's desk.
/// Returns when nothing is left to help with, or the desk says so. Throws as above.
void help_isolated(const JobTask& task, const asset::Input& input, const api::Limits& limits,
                   const Isolation& isolation);

/// render() in a process of its own. Throws what that throws, and WorkerCrashed; Error{cancelled}
/// once it was stopped.
std::string render_isolated(const Rendering& rendering, const RenderingInput& input,
                            const std::stop_token& stop, const api::Limits& limits,
                            const Isolation& isolation);

}  // namespace unwrapd::server::work
