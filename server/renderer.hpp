#pragma once
// Results in other formats and pictures, made from what a job keeps: here, or with --isolate in a
// worker process of its own, so that a crash costs the request and no more.

#include <string>

#include "api/limits.hpp"
#include "server/blob_store.hpp"
#include "server/duties.hpp"
#include "server/job_process.hpp"
#include "server/job_record.hpp"
#include "server/log.hpp"

namespace unwrapd::server {

/// Thread-safe.
class Renderer {
 public:
  Renderer(const BlobStore& blobs, const api::Limits& limits, const Log& log,
           const Isolation& isolation, const Duties& duties = {})
      : blobs_(blobs), limits_(limits), log_(log), isolation_(isolation), duties_(duties) {}

  /// The bytes of a file of a succeeded job. Throws what render() throws, storage_corrupt, and in a
  /// process time_limit, memory_limit, and internal when the process has ended.
  [[nodiscard]] std::string render(const JobRecord& job, const Rendering& rendering) const;

 private:
  [[nodiscard]] std::string render_apart(const Rendering& rendering,
                                         const RenderingInput& input) const;

  const BlobStore& blobs_;
  const api::Limits& limits_;
  const Log& log_;
  const Isolation isolation_;
  const Duties duties_;
};

}  // namespace unwrapd::server
