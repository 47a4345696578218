#include "server/config/component_config.hpp"

#include <algorithm>
#include <string>

#include "core/base/error.hpp"

namespace unwrapd::server::config {
namespace {

constexpr int kLeastMakers = 4;
constexpr std::chrono::seconds kStopPatience{5};  // beyond the grace of a job
constexpr int kAdminThreads = 4;
constexpr int kAdminConnections = 64;
constexpr int kAdminParked = 48;  // so that idle connections keep no other out

constexpr std::int64_t kOfTheServer = 32;  // stores, listeners, wakeups, folders
constexpr std::int64_t kOfARequest = 3;    // a file, its digests, the folder of both
constexpr std::int64_t kOfAWorker = 13;    // a mesh with buffers, its results, two processes
constexpr std::int64_t kOfADownload = 6;   // its socket and wakeup, the file, the folder, DNS
constexpr std::int64_t kFewestParts = 4;   // at least a quarter is for connections

int most_downloads(const Config& config) {
  return config.sources.allowed_hosts.empty() ? 0 : config.sources.at_once;
}

}  // namespace

http::HttpConfig http_config(const Config& config) {
  const EdgeConfig& edge = config.edge;
  http::HttpConfig http;
  http.address = config.listen;
  const results::RenderLimits making = render_limits(config, 0);
  http.max_requests = edge.max_requests;
  http.max_held = most_waiting(config) + making.waiting + making.places + most_downloads(config);
  http.max_connections = edge.max_connections;
  http.max_connections_per_address = edge.max_connections_per_address;
  http.idle_connections.max_idle = edge.max_idle_connections;
  http.tls_certificate = edge.tls_cert;
  http.tls_key = edge.tls_key;
  http.limits.max_body_bytes = config.limits.max_body_bytes;
  return http;
}

http::HttpConfig admin_config(const http::Address& address) {
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

void warn_without_keys(const Config& config, bool has_keys, const Log& log) {
  if (!access::asks_for_keys(config.access, config.listen.host) || has_keys) return;
  log.warning("API keys are required and none exists yet; add one",
              {{"command", "unwrapd keys add --data " + config.data.string() +
                               (config.database.url.empty() ? "" : " --database URL") +
                               " --name NAME --scopes submit,read"}});
}

results::RenderLimits render_limits(const Config& config, std::size_t memory_bytes) {
  return {.places = std::max(kLeastMakers, config.workers),
          .waiting = most_waiting(config),
          .bytes = memory_bytes};
}

results::ResultsFrom results_from(const Config& config) {
  return config.bucket.redirects ? results::ResultsFrom::bucket : results::ResultsFrom::node;
}

int connections_within(std::int64_t files, const Config& config) {
  if (files < kFewestDescriptors) {
    throw Error(ErrorCode::internal,
                "Only " + std::to_string(files) + " files may be open; allow " +
                    std::to_string(kFewestDescriptors) + " or more (ulimit -n, LimitNOFILE).");
  }
  const std::int64_t admin = config.admin ? admin_config(*config.admin).max_connections : 0;
  const std::int64_t kept_back = kOfTheServer + kOfARequest * http_config(config).max_requests +
                                 kOfAWorker * config.workers +
                                 kOfADownload * most_downloads(config) + admin;
  const std::int64_t left = std::max(files - kept_back, files / kFewestParts);
  return static_cast<int>(std::min<std::int64_t>(left, config.edge.max_connections));
}

}  // namespace unwrapd::server::config
