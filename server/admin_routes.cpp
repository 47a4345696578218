#include "server/admin_routes.hpp"

namespace unwrapd::server {
namespace {

constexpr std::string_view kOk = R"({"status":"ok"})";

/// Whether the server takes jobs: not while it drains, nor while they cannot be stored. A full
/// queue or disk passes by itself.
Response readiness(const JobQueue& queue, JobStore& store) {
  if (!queue.draining()) {
    store.check_writable();
    return json_response(200, kOk);
  }
  throw RetryLater(ErrorCode::draining, "The server is shutting down; use another.", 1);
}

Response metrics_text(const Metrics& metrics) {
  Response response;
  response.content_type = Metrics::kContentType;
  response.body = metrics.text();
  return response;
}

Response version() {
  return json_response(200, api::Json{{"name", "unwrapd"}, {"version", UNWRAPD_VERSION}}.dump());
}

}  // namespace

void add_probe_routes(std::vector<Route>& routes, const JobQueue& queue, JobStore& store) {
  routes.push_back({"GET", "/healthz", [](const Request&) { return json_response(200, kOk); }});
  routes.push_back({"GET", "/readyz", [&](const Request&) { return readiness(queue, store); }});
}

std::vector<Route> admin_routes(const JobQueue& queue, JobStore& store, const Metrics& metrics) {
  std::vector<Route> routes;
  add_probe_routes(routes, queue, store);
  routes.push_back({"GET", "/metrics", [&](const Request&) { return metrics_text(metrics); }});
  routes.push_back({"GET", "/version", [](const Request&) { return version(); }});
  return routes;
}

}  // namespace unwrapd::server
