#include "server/routes/admin_routes.hpp"

#include <optional>

#include "server/base/errors.hpp"

namespace unwrapd::server::routes {
namespace {

constexpr std::string_view kOk = R"({"status":"ok"})";

/// Whether the server takes jobs: not while it drains, nor while they cannot be stored or worked
/// on, nor while accepted jobs wait for room on the disk. A full queue passes by itself.
http::Response answer(const Readiness& readiness) {
  if (readiness.queue.draining()) throw shutting_down();
  readiness.store.check_writable();
  if (const std::optional<RetryLater> shortage = readiness.queue.shortage()) throw *shortage;
  if (!readiness.has_workers())
    throw Error(ErrorCode::internal, "Jobs that do not stop hold every worker.");
  if (!readiness.has_files())
    throw Error(ErrorCode::storage_failed,
                "Files of the store are missing; the operator must restore them.");
  return http::json_response(200, kOk);
}

http::Response metrics_text(const Metrics& metrics) {
  http::Response response;
  response.content_type = Metrics::kContentType;
  response.body = metrics.text();
  return response;
}

http::Response version() {
  return http::json_response(200,
                             api::Json{{"name", "unwrapd"}, {"version", UNWRAPD_VERSION}}.dump());
}

}  // namespace

void add_probe_routes(std::vector<http::Route>& routes, const Readiness& readiness) {
  routes.push_back(
      {"GET", "/healthz", [](const http::Request&) { return http::json_response(200, kOk); }});
  routes.push_back(
      {"GET", "/readyz", [readiness](const http::Request&) { return answer(readiness); }});
}

std::vector<http::Route> admin_routes(const Readiness& readiness, const Metrics& metrics) {
  std::vector<http::Route> routes;
  add_probe_routes(routes, readiness);
  routes.push_back(
      {"GET", "/metrics", [&](const http::Request&) { return metrics_text(metrics); }});
  routes.push_back({"GET", "/version", [](const http::Request&) { return version(); }});
  return routes;
}

}  // namespace unwrapd::server::routes
