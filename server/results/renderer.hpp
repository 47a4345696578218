#pragma once
// Results in other formats and pictures, made from the stored files of a job: in this process, or
// with --isolate in a worker process, so that a crash costs only the request.

#include <memory>
#include <string>

#include "api/limits.hpp"
#include "server/base/log.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/results/render_limiter.hpp"
#include "server/store/job_record.hpp"
#include "server/work/job_process.hpp"
#include "server/work/job_worker.hpp"

namespace unwrapd::server::results {

/// A requested file of a job.
struct WantedFile {
  std::string file;
  std::size_t map = 0;            ///< that it is made from
  std::size_t bytes = 0;          ///< of memory that it takes besides what its mesh does
  bool is_kept = true;            ///< with the job, for the next request
  bool is_costly = false;         ///< takes seconds and is not kept
  const http::HasLeft& has_left;  ///< of the request
};

/// Thread-safe.
class Renderer {
 public:
  Renderer(const blobs::BlobStore& blobs, const api::Limits& limits, const Log& log,
           const work::Isolation& isolation, const RenderLimits& making,
           const work::WorkerFunctions& functions = {})
      : blobs_(blobs),
        limits_(limits),
        log_(log),
        isolation_(isolation),
        job_bytes_(making.bytes),
        room_(making),
        functions_(functions) {}

  /// Waits until a file of a job may be made. The caller may make it while it holds the pointer,
  /// unless it was made meanwhile. Throws RetryLater{rate_limited} when too many requests wait,
  /// Error{cancelled} when the client has left.
  [[nodiscard]] std::shared_ptr<void> enter(const store::JobRecord& job, const WantedFile& wanted);

  /// The bytes of a file of a succeeded job, made by a thread of low priority. Throws what
  /// work::render() throws, storage_corrupt, time_limit, cancelled when the client has left, and
  /// from a process memory_limit, and internal when the process has ended.
  [[nodiscard]] std::string render(const store::JobRecord& job, const work::Rendering& rendering,
                                   const http::HasLeft& has_left = {}) const;

  /// What a stored mesh is, as JSON (Rendering::analysis); mesh: the job that it could be. Throws
  /// like render().
  [[nodiscard]] std::string analyse(const store::JobRecord& mesh,
                                    const http::HasLeft& has_left = {}) const;

 private:
  [[nodiscard]] std::string make(const work::Rendering& rendering, work::RenderingInput input,
                                 const http::HasLeft& has_left) const;
  [[nodiscard]] std::string make_here(const work::Rendering& rendering,
                                      const work::RenderingInput& input) const;

  const blobs::BlobStore& blobs_;
  const api::Limits& limits_;
  const Log& log_;
  const work::Isolation isolation_;
  const std::size_t job_bytes_;  // of memory, that a job may take
  RenderLimiter room_;
  const work::WorkerFunctions functions_;
};

}  // namespace unwrapd::server::results
