#pragma once
// Results in other formats and pictures, made from what a job keeps: here, or with --isolate in a
// worker process of its own, so that a crash costs the request and no more.

#include <memory>
#include <string>

#include "api/limits.hpp"
#include "server/base/log.hpp"
#include "server/results/making_room.hpp"
#include "server/store/blob_store.hpp"
#include "server/store/job_record.hpp"
#include "server/work/duties.hpp"
#include "server/work/job_process.hpp"

namespace unwrapd::server {

/// A file of a job that somebody asks for.
struct WantedFile {
  std::string file;
  std::size_t map = 0;      ///< that it is made from
  std::size_t bytes = 0;    ///< of memory that it takes besides what its mesh does
  bool is_costly = false;   ///< takes seconds and is not kept
  const HasLeft& has_left;  ///< of who asks
};

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
  /// kept, unless somebody has made it meanwhile. Throws RetryLater{rate_limited} when too many
  /// wait, Error{cancelled} when who asks has left.
  [[nodiscard]] std::shared_ptr<void> enter(const JobRecord& job, const WantedFile& wanted);

  /// The bytes of a file of a succeeded job, made by a thread that yields to answers. Throws what
  /// render() throws, storage_corrupt, time_limit, cancelled when who asks has left, and in a
  /// process memory_limit, and internal when the process has ended.
  [[nodiscard]] std::string render(const JobRecord& job, const Rendering& rendering,
                                   const HasLeft& has_left = {}) const;

  /// What a stored mesh is (mesh_analysis.hpp), which is given as the job that it could be. Throws
  /// like render().
  [[nodiscard]] std::string analyse(const JobRecord& mesh, const HasLeft& has_left = {}) const;

 private:
  [[nodiscard]] std::string make(const Rendering& rendering, RenderingInput input,
                                 const HasLeft& has_left) const;
  [[nodiscard]] std::string make_here(const Rendering& rendering,
                                      const RenderingInput& input) const;

  const BlobStore& blobs_;
  const api::Limits& limits_;
  const Log& log_;
  const Isolation isolation_;
  const std::size_t job_bytes_;  // of memory, that a job may take
  MakingRoom room_;
  const Duties duties_;
};

}  // namespace unwrapd::server
