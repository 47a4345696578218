#pragma once
// From a request with a mesh, or the name of a stored one, to a queued job: cheap checks before the
// body is read, the body straight to disk, and the job in the queue when all of it is there.

#include <mutex>
#include <optional>
#include <string>

#include "api/limits.hpp"
#include "api/options.hpp"
#include "server/http/http.hpp"
#include "server/http/media_types.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/store/blob_store.hpp"
#include "server/uploads/job_input.hpp"
#include "server/uploads/meshes.hpp"
#include "server/uploads/upload_room.hpp"
#include "server/webhooks/webhook_url.hpp"

namespace unwrapd::server {

class Submissions {
 public:
  Submissions(JobQueue& queue, JobStore& store, BlobStore& blobs, const api::Limits& limits,
              const WebhookConfig& webhooks, Meshes& meshes, const UploadRooms& rooms)
      : queue_(queue),
        store_(store),
        blobs_(blobs),
        rooms_(rooms),
        limits_(limits),
        webhooks_(webhooks),
        meshes_(meshes) {}

  /// Returns the job's id. synchronous: the sender waits, so the mesh must be small. Where the path
  /// has an id, it becomes the job's; a request by Idempotency-Key or by such an id may come again
  /// and gets the same job. Throws Error: queue_full, draining, unsupported_media_type,
  /// invalid_option, malformed_request, body_too_large, idempotency_conflict, too_many_jobs,
  /// quota_exceeded, storage_full, storage_failed, webhook_refused, mesh_not_found.
  std::string accept(const Request& request, bool synchronous);

 private:
  /// What a body says beside the mesh, and the turn to do something about it where that is much.
  struct Sent {
    std::unique_lock<std::mutex> turn;
    std::optional<std::string> options;  // JSON text
  };

  [[nodiscard]] std::optional<JobRecord> known_job(const Request& request);
  [[nodiscard]] JobRecord begin_job(const Request& request, const std::string& upload,
                                    bool synchronous) const;
  [[nodiscard]] Sent read_whole(SpooledText& text);
  [[nodiscard]] Sent bring(const Request& request, const UploadFolder& folder, JobRecord& job);
  [[nodiscard]] Sent bring_reference(const Request& request, const UploadFolder& folder,
                                     JobRecord& job);
  void receive(const Request& request, JobRecord& job, UploadRoom& room, const std::string& upload);

  JobQueue& queue_;
  JobStore& store_;
  BlobStore& blobs_;
  const UploadRooms& rooms_;
  const api::Limits& limits_;
  const WebhookConfig& webhooks_;
  Meshes& meshes_;
  std::mutex reading_;
};

}  // namespace unwrapd::server
