#pragma once
// What a worker does with one job, from the bytes of its mesh to the files of its answer.

#include <string>

#include "api/limits.hpp"
#include "core/asset/asset.hpp"
#include "core/executor.hpp"
#include "server/blob_store.hpp"
#include "server/job_queue.hpp"

namespace unwrapd::server {

/// Reads, unwraps, writes; events go to the job's feed. Returns the result's format: glb, gltf or
/// obj. Its files are all in place then. Throws Error, also {cancelled} when the job's stop token
/// says so.
std::string run_job(const RunningJob& job, BlobStore& blobs, const api::Limits& limits,
                    Executor& executor);

/// The most that may be read for a job: less for one that somebody waits for.
asset::ReadLimits read_limits(const JobRecord& job, const api::Limits& limits);

}  // namespace unwrapd::server
