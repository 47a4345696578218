#pragma once
// What a worker does with one job, from the bytes of its mesh to the files of its answer.

#include <stop_token>
#include <string>

#include "api/limits.hpp"
#include "core/asset/asset.hpp"
#include "core/base/executor.hpp"
#include "server/store/job_record.hpp"
#include "server/work/job_output.hpp"
#include "server/work/stage_timer.hpp"

namespace unwrapd::server::work {

/// A job at work. Of its record only the options, the notes, the input's digest and size, and
/// whether somebody waits for it count.
struct JobTask {
  const store::JobRecord& record;
  double queue_ms = 0;  ///< for which it has waited
  StageTimer::TimePoint began;
  std::stop_token stop;
};

/// Reads, unwraps, writes to the output. Returns the result's format: glb, gltf or obj. Its files
/// have all been handed over then. Throws Error, also {cancelled} when the stop token says so.
std::string run_job(const JobTask& task, const asset::Input& input, JobOutput& output,
                    const api::Limits& limits, Executor& executor);

/// The most that may be read for a job: less for one that somebody waits for.
asset::ReadLimits read_limits(const store::JobRecord& job, const api::Limits& limits,
                              std::size_t memory_bytes = asset::kNoByteLimit);

}  // namespace unwrapd::server::work
