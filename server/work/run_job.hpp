#pragma once
// One job, from the bytes of its mesh to the files of its answer.

#include <stop_token>
#include <string>
#include <string_view>

#include "api/limits.hpp"
#include "core/asset/asset.hpp"
#include "core/base/executor.hpp"
#include "core/types/note.hpp"
#include "core/types/progress.hpp"
#include "server/store/job_record.hpp"
#include "server/work/stage_timer.hpp"
#include "server/work/work_desk.hpp"

namespace unwrapd::server::work {

/// Takes the events and files of a running job: to its feed and its folder, or to the process that
/// has both (job_process.hpp).
class JobOutput {
 public:
  JobOutput() = default;
  JobOutput(const JobOutput&) = delete;
  JobOutput& operator=(const JobOutput&) = delete;
  virtual ~JobOutput() = default;

  virtual void stage(const StageEvent& event) = 0;
  /// elapsed_ms: since the job began.
  virtual void iteration(const IterationEvent& event, double elapsed_ms) = 0;
  /// A note of the report of the job's first map.
  virtual void note(const Note& note) = 0;
  /// The answer's asset. format: glb, gltf or obj.
  virtual void result(std::string_view format, std::string_view bytes) = 0;
  /// A further file of the job's folder.
  virtual void file(std::string_view name, std::string_view bytes) = 0;
};

/// Of a process that helps with a job, or of which nothing but the last word is wanted.
class NoOutput final : public JobOutput {
 public:
  void stage(const StageEvent& /*event*/) override {}
  void iteration(const IterationEvent& /*event*/, double /*elapsed_ms*/) override {}
  void note(const Note& /*note*/) override {}
  void result(std::string_view /*format*/, std::string_view /*bytes*/) override {}
  void file(std::string_view /*name*/, std::string_view /*bytes*/) override {}
};

/// A running job. Of its record only the options, the notes, the input's digest and size, and
/// `synchronous` are used.
struct JobTask {
  const store::JobRecord& record;
  double queue_ms = 0;  ///< spent in the queue
  StageTimer::TimePoint began;
  std::stop_token stop;
  WorkDesk* desk = nullptr;  ///< of a job that runs in a process of its own; null: it is alone
};

/// Reads, unwraps, and writes to the output. Returns the format of the result (glb, gltf or obj)
/// when all files have been handed over. Throws Error; {cancelled} once the stop token asks for it.
std::string run_job(const JobTask& task, const asset::Input& input, JobOutput& output,
                    const api::Limits& limits, Executor& executor);

/// Limits for reading the mesh of a job: lower for a synchronous one.
asset::ReadLimits read_limits(const store::JobRecord& job, const api::Limits& limits,
                              std::size_t memory_bytes = asset::kNoByteLimit);

}  // namespace unwrapd::server::work
