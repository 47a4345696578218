#pragma once
// From a request with a mesh, or the name of a stored one, to a queued job: cheap checks before the
// body is read, the body straight to disk, and the job in the queue when all of it is there.

#include <mutex>

#include "api/limits.hpp"
#include "api/options.hpp"
#include "server/blob_store.hpp"
#include "server/http.hpp"
#include "server/job_input.hpp"
#include "server/job_queue.hpp"
#include "server/media_types.hpp"
#include "server/meshes.hpp"
#include "server/upload_room.hpp"
#include "server/webhook_url.hpp"

namespace unwrapd::server {

class Submissions {
 public:
  Submissions(JobQueue& queue, JobStore& store, BlobStore& blobs, const api::Limits& limits,
              const WebhookConfig& webhooks, Meshes& meshes)
      : queue_(queue),
        store_(store),
        blobs_(blobs),
        limits_(limits),
        webhooks_(webhooks),
        meshes_(meshes) {}

  /// synchronous: the sender waits, so the mesh must be small. Where the path has an id, it becomes
  /// the job's; a request by Idempotency-Key or by such an id may come again and gets the same job.
  /// Throws Error: queue_full, draining, unsupported_media_type, invalid_option, malformed_request,
  /// body_too_large, idempotency_conflict, too_many_jobs, quota_exceeded, storage_full,
  /// storage_failed, webhook_refused, mesh_not_found.
  JobRecord accept(const Request& request, bool synchronous);

 private:
  [[nodiscard]] UploadRoom room_for(const Request& request, BodyKind kind,
                                    const std::string& upload);
  /// JSON in memory is many times its text: long ones are read one at a time.
  [[nodiscard]] std::unique_lock<std::mutex> turn_to_read(std::size_t bytes);
  [[nodiscard]] Upload bring(const Request& request, BodyKind kind, const std::string& upload);
  [[nodiscard]] Submission receive(const Request& request, const std::string& upload);

  JobQueue& queue_;
  JobStore& store_;
  BlobStore& blobs_;
  const api::Limits& limits_;
  const WebhookConfig& webhooks_;
  Meshes& meshes_;
  std::mutex reading_;
};

}  // namespace unwrapd::server
