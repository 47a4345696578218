#pragma once
// Metrics of the parts of a server: its connections, how often caches are asked, what they have.

#include <filesystem>

#include "server/base/metrics.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/http/http_server.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/webhooks/webhooks.hpp"
#include "server/work/solver_cache.hpp"

namespace unwrapd::server {

/// Files that are made on request.
struct MadeFiles {
  const FileCounts* results;
  const FileCounts* pictures;
  const FileCounts* analyses;
};

/// What is told of must outlive the metrics.
void tell_jobs(Metrics& metrics, jobs::JobQueue& queue);
/// root: where the files are.
void tell_store(Metrics& metrics, blobs::BlobStore& blobs, const std::filesystem::path& root,
                webhooks::Webhooks& webhooks);
void tell_connections(Metrics& metrics, const http::HttpServer& http);
void tell_caches(Metrics& metrics, const work::SolverCache& solver, const MadeFiles& files);

}  // namespace unwrapd::server
