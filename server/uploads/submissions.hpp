#pragma once
// From a request with a mesh, or the name of a stored one, to a queued job: cheap checks before the
// body is read, the body straight to disk, and the job in the queue when all of it is there.

#include <mutex>
#include <optional>
#include <string>

#include "api/limits.hpp"
#include "api/options.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/http/http.hpp"
#include "server/http/media_types.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/sources/sources.hpp"
#include "server/uploads/job_input.hpp"
#include "server/uploads/meshes.hpp"
#include "server/uploads/upload_budget.hpp"
#include "server/webhooks/webhook_url.hpp"

namespace unwrapd::server::uploads {

class Submissions {
 public:
  Submissions(jobs::JobQueue& queue, store::JobStore& store, blobs::BlobStore& blobs,
              const api::Limits& limits, const webhooks::WebhookConfig& webhooks, Meshes& meshes,
              sources::Sources& sources, const UploadRooms& rooms)
      : queue_(queue),
        store_(store),
        blobs_(blobs),
        rooms_(rooms),
        limits_(limits),
        webhooks_(webhooks),
        meshes_(meshes),
        sources_(sources) {}

  /// Returns the job's id. synchronous: the sender waits, so the mesh must be small. Where the path
  /// names a stored mesh, the body is its options. Where it has an id, it becomes the job's; a
  /// request by Idempotency-Key or by such an id may come again and gets the same job. Throws
  /// Error: queue_full, draining, unsupported_media_type, invalid_option, malformed_request,
  /// body_too_large, idempotency_conflict, too_many_jobs, quota_exceeded, storage_full,
  /// storage_failed, webhook_refused, mesh_not_found, source_refused, source_failed; by a ticket,
  /// which names the request, also forbidden and invalid_link.
  std::string accept(const http::Request& request, bool synchronous);

 private:
  struct Sent;

  [[nodiscard]] std::optional<store::JobRecord> known_job(const http::Request& request);
  [[nodiscard]] store::JobRecord begin_job(const http::Request& request, const std::string& upload,
                                           bool synchronous) const;
  [[nodiscard]] Sent read_whole(SpooledText& text);
  [[nodiscard]] Sent bring(const http::Request& request, const store::UploadFolder& folder,
                           store::JobRecord& job);
  [[nodiscard]] Sent bring_reference(const http::Request& request,
                                     const store::UploadFolder& folder, store::JobRecord& job);
  /// Reads the mesh from its address, as if it were the body.
  void bring_source(const http::Request& request, const store::UploadFolder& folder, Sent& sent,
                    store::JobRecord& job);
  /// The options alone, of a job on the mesh that the path names.
  [[nodiscard]] Sent bring_options(const http::Request& request, const store::UploadFolder& folder,
                                   store::JobRecord& job);
  void receive(const http::Request& request, store::JobRecord& job, UploadBudget& room,
               const std::string& upload);

  jobs::JobQueue& queue_;
  store::JobStore& store_;
  blobs::BlobStore& blobs_;
  const UploadRooms& rooms_;
  const api::Limits& limits_;
  const webhooks::WebhookConfig& webhooks_;
  Meshes& meshes_;
  sources::Sources& sources_;
  std::mutex reading_;
};

}  // namespace unwrapd::server::uploads
