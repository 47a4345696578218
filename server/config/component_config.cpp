#include "server/config/component_config.hpp"

#include <algorithm>

namespace unwrapd::server::config {
namespace {

constexpr int kLeastMakers = 4;
constexpr std::chrono::seconds kStopPatience{5};  // beyond the grace of a job
constexpr int kAdminThreads = 4;
constexpr int kAdminConnections = 64;
constexpr int kAdminParked = 48;  // so that idle ones keep nobody out

}  // namespace

http::HttpConfig http_config(const Config& config) {
  const EdgeConfig& edge = config.edge;
  http::HttpConfig http;
  http.address = config.listen;
  const results::RenderLimits making = render_limits(config, 0);
  http.max_requests = edge.max_requests;
  http.max_held = most_waiting(config) + making.waiting + making.places;
  http.max_connections = edge.max_connections;
  http.max_connections_per_address = edge.max_connections_per_address;
  http.idle_connections.max_idle = edge.max_idle_connections;
  http.tls_certificate = edge.tls_cert;
  http.tls_key = edge.tls_key;
  http.limits.max_body_bytes = config.limits.max_body_bytes;
  return http;
}

http::HttpConfig admin_config(const Address& address) {
  http::HttpConfig http;
  http.address = address;
  http.option = "--admin-listen";
  http.max_requests = kAdminThreads;
  http.max_connections = kAdminConnections;
  http.idle_connections.max_parked = kAdminParked;
  return http;
}

work::Isolation isolation_of(const Config& config, const work::SolverCache& cache,
                             const work::WorkerFunctions& functions) {
  work::Isolation isolation{.program = functions.program};
  isolation.grace = std::chrono::seconds(config.grace_seconds);
  isolation.threads = config.threads;
  isolation.memory_bytes = static_cast<std::int64_t>(cache.memory_limit());
  if (config.isolate == Isolate::on)
    work::check_isolation(isolation);
  else
    isolation.why_not = isolation.program.empty() ? "The program of the worker process is missing."
                                                  : work::why_not(isolation);
  isolation.possible = isolation.why_not.empty();
  isolation.on = isolation.possible && config.isolate != Isolate::off;
  if (isolation.on)
    isolation.spares = work::spare_workers(config.workers, config.limits, isolation);
  return isolation;
}

int most_waiting(const Config& config) { return std::max(1, config.edge.max_requests / 2); }

std::chrono::seconds most_stopping(const Config& config) {
  return std::chrono::seconds(config.grace_seconds) + kStopPatience;
}

void tell_isolation(const work::Isolation& isolation, const Config& config, const Log& log,
                    Metrics& metrics) {
  metrics.tell(Metric::isolation, {}, [on = isolation.on] { return on ? 1 : 0; });
  if (isolation.on) return log.info("each job runs in its own process");
  const bool wanted = config.isolate == Isolate::automatic && !isolation.program.empty();
  if (wanted) log.warning("jobs run in the server's process", {{"reason", isolation.why_not}});
}

results::RenderLimits render_limits(const Config& config, std::size_t memory_bytes) {
  return {.places = std::max(kLeastMakers, config.workers),
          .waiting = most_waiting(config),
          .bytes = memory_bytes};
}

}  // namespace unwrapd::server::config
