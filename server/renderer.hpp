#pragma once
// Results in other formats and pictures, made from what a job keeps: here, or with --isolate in a
// worker process of its own, so that a crash costs the request and no more.

#include <memory>
#include <string>

#include "api/limits.hpp"
#include "server/blob_store.hpp"
#include "server/duties.hpp"
#include "server/job_process.hpp"
#include "server/job_record.hpp"
#include "server/log.hpp"
#include "server/making_room.hpp"

namespace unwrapd::server {

/// Thread-safe.
class Renderer {
 public:
  Renderer(const BlobStore& blobs, const api::Limits& limits, const Log& log,
           const Isolation& isolation, const MakingLimits& making, const Duties& duties = {})
      : blobs_(blobs),
        limits_(limits),
        log_(log),
        isolation_(isolation),
        job_bytes_(making.bytes),
        room_(making),
        duties_(duties) {}

  /// Waits until a file of a job may be made; then it is the caller's to make while the pointer is
  /// kept, unless somebody has made it meanwhile. map: that it is made from. Throws
  /// RetryLater{rate_limited} when too many wait.
  [[nodiscard]] std::shared_ptr<void> enter(const JobRecord& job, std::size_t map,
                                            const std::string& file);

  /// The bytes of a file of a succeeded job. Throws what render() throws, storage_corrupt, and in a
  /// process time_limit, memory_limit, and internal when the process has ended.
  [[nodiscard]] std::string render(const JobRecord& job, const Rendering& rendering) const;

  /// What a stored mesh is (mesh_analysis.hpp), which is given as the job that it could be. Throws
  /// like render().
  [[nodiscard]] std::string analyse(const JobRecord& mesh) const;

 private:
  [[nodiscard]] std::string make(const Rendering& rendering, RenderingInput input) const;

  const BlobStore& blobs_;
  const api::Limits& limits_;
  const Log& log_;
  const Isolation isolation_;
  const std::size_t job_bytes_;  // of memory, that a job may take
  MakingRoom room_;
  const Duties duties_;
};

}  // namespace unwrapd::server
