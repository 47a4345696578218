#pragma once
// The admin port: what those who run the server ask, and nobody else should. Probes and metrics
// have an address of their own, so that they answer when the service itself is full, and need no
// key.

#include <functional>
#include <vector>

#include "server/base/metrics.hpp"
#include "server/http/router.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server::routes {

/// Who says whether jobs are taken.
struct Readiness {
  const jobs::JobQueue& queue;
  store::JobStore& store;
  std::function<bool()> has_files;  ///< whether those of the store are there
  std::function<bool()> has_workers;
};

/// GET /healthz, /readyz, /metrics, /version.
std::vector<http::Route> admin_routes(const Readiness& readiness, const Metrics& metrics);

/// The first two alone, which the service's own port has as well.
void add_probe_routes(std::vector<http::Route>& routes, const Readiness& readiness);

}  // namespace unwrapd::server::routes
