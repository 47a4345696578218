// The table of all options of the server: the name, range and sentence of each.
#include <algorithm>

#include "server/config/config_row.hpp"
#include "server/http/addresses.hpp"

namespace unwrapd::server::config {
namespace {

constexpr std::int64_t kMaxBodyBytes = std::int64_t{4} * 1024 * 1024 * 1024;
constexpr std::int64_t kMaxMemoryBytes = std::int64_t{1} << 60;
constexpr int kMaxThreads = 256;
constexpr int kMaxStreams = 4096;
constexpr std::string_view kNoAdmin = "off";

http::Address address_of(const std::string& text) {
  const std::optional<http::Address> address = http::parse_address(text);
  if (!address) expected("HOST:PORT with a port from 0 to 65535");
  return *address;
}

ConfigRow listen_row() {
  return {.heading = {"listen", "HOST:PORT", "Address of the service; port 0 takes a free port"},
          .kind = ConfigKind::text,
          .set = [](Config& config, const std::string& text) { config.listen = address_of(text); },
          .get = [](const Config& config) { return to_text(config.listen); }};
}

ConfigRow admin_row() {
  return {.heading = {"admin-listen", "HOST:PORT",
                      "Address of probes and metrics, or off. Unset: 127.0.0.1 with the port after "
                      "that of --listen"},
          .kind = ConfigKind::text,
          .set =
              [](Config& config, const std::string& text) {
                config.admin.reset();
                if (text != kNoAdmin) config.admin = address_of(text);
              },
          .get =
              [](const Config& config) {
                return config.admin ? to_text(*config.admin) : std::string(kNoAdmin);
              }};
}

ConfigGroup serving() { return {.title = "Serving", .rows = {listen_row(), admin_row()}}; }

void check_range(const std::string& item) { const http::AddressSet set({item}); }

ConfigGroup edge() {
  using E = EdgeConfig;
  const auto edge = &Config::edge;
  return {
      .title = "Connections",
      .rows = {
          number({"max-connections", "N",
                  "Most open connections (fewer if the system allows few open files); others are "
                  "refused"},
                 {16, 1'000'000}, edge, &E::max_connections),
          number({"max-idle-connections", "N",
                  "Most open connections that are idle; beyond it, the one idle for longest is "
                  "closed"},
                 {1, 1'000'000}, edge, &E::max_idle_connections),
          number({"max-connections-per-address", "N",
                  "Most open connections of one client address (IPv6: of its /64). Loopback and "
                  "trusted proxies are not counted. 0: no limit"},
                 {0, 1'000'000}, edge, &E::max_connections_per_address),
          number({"max-requests", "N",
                  "Requests answered at once. Event streams, and half as many requests that wait "
                  "for jobs or pictures, are additional"},
                 {1, 4096}, edge, &E::max_requests),
          list(
              {"trusted-proxies", "RANGES",
               "Addresses and ranges (10.0.0.0/8,::1) of proxies whose X-Forwarded-For is trusted"},
              check_range, edge, &E::trusted_proxies),
          text({"tls-cert", "PATH", "PEM file of the certificate and its chain; turns HTTPS on"},
               edge, &E::tls_cert),
          text({"tls-key", "PATH", "PEM file of the certificate's private key"}, edge,
               &E::tls_key)}};
}

/// true and false are on and off, which is what the option once was.
ConfigRow isolate_row() {
  ConfigRow row = choice(
      {"isolate", "",
       "Run each job in its own process without files or network, so that a crash fails only that "
       "job; further jobs of one key on one mesh may follow in it. --isolate=auto: where the "
       "kernel allows it; on: always, or the server does not start; "
       "off: jobs run in the server, which can then cache work between all jobs on the same mesh. "
       "Default: auto"},
      Names<Isolate>{{"auto", Isolate::automatic}, {"on", Isolate::on}, {"off", Isolate::off}},
      &Config::isolate);
  row.kind = ConfigKind::switch_of_text;
  row.set = [set = row.set](Config& config, const std::string& text) {
    set(config, text == "true" ? "on" : text == "false" ? "off" : text);
  };
  return row;
}

ConfigGroup working() {
  return {
      .title = "Jobs",
      .rows = {text({"data", "PATH", "Directory of jobs and results; created if missing"},
                    &Config::data),
               number({"workers", "N",
                       "Jobs that run at once. 0: none; the other nodes of --blobs run them"},
                      {0, kMaxThreads}, &Config::workers),
               number({"threads", "N", "Threads of each job"}, {1, kMaxThreads}, &Config::threads),
               number({"memory-limit", "N",
                       "Bytes of memory for one job; a job that would need more is refused. 0: its "
                       "share of the machine"},
                      {0, kMaxMemoryBytes}, &Config::memory, &work::MemoryLimits::job_bytes),
               number({"solver-cache-bytes", "N",
                       "Bytes of memory for factors and maps that are cached for further jobs on "
                       "the same mesh (with --isolate=off)"},
                      {0, kMaxMemoryBytes}, &Config::memory, &work::MemoryLimits::cache_bytes),
               isolate_row(),
               number({"grace-seconds", "N",
                       "Seconds that a job may take to stop after its owner or --max-job-seconds "
                       "stops it; then its process is killed, or its thread abandoned"},
                      {0, 3600}, &Config::grace_seconds),
               number({"drain-seconds", "N",
                       "Seconds that running jobs may continue after SIGTERM; a second signal ends "
                       "the wait. Jobs that do not stop, and last answers, may take 15 s and "
                       "--grace-seconds more"},
                      {0, kMaxCount}, &Config::drain_seconds)}};
}

ConfigGroup telling() {
  const Names<LogLevel> levels = {{"debug", LogLevel::debug},
                                  {"info", LogLevel::info},
                                  {"warning", LogLevel::warning},
                                  {"error", LogLevel::error},
                                  {"off", LogLevel::off}};
  const Names<LogFormat> formats = {{"json", LogFormat::json}, {"text", LogFormat::text}};
  return {.title = "Logging",
          .rows = {choice({"log-level", "LEVEL",
                           "Least severe messages to log: debug, info, warning, error or off"},
                          levels, &Config::log_level),
                   choice({"log-format", "FORMAT", "Format of log lines: json or text"}, formats,
                          &Config::log_format)}};
}

template <class Number>
ConfigRow limit(const ConfigHeading& heading, Range range, Number api::Limits::*limit) {
  return number(heading, range, &Config::limits, limit);
}

ConfigGroup limits() {
  using api::Limits;
  return {.title = "Limits",
          .rows = {limit({"max-body-bytes", "N", "Most bytes of one request body"},
                         {1024, kMaxBodyBytes}, &Limits::max_body_bytes),
                   limit({"max-vertices", "N", "Most vertices of an asset"}, {3, kMaxCount},
                         &Limits::max_vertices),
                   limit({"max-faces", "N", "Most triangles of an asset"}, {1, kMaxCount},
                         &Limits::max_faces),
                   limit({"max-sync-faces", "N", "Most triangles of an asset sent to /v1/unwrap"},
                         {1, kMaxCount}, &Limits::max_sync_faces),
                   limit({"max-iterations", "N",
                          "Largest value of the options stop.iterations and stop.max_iterations"},
                         {1, 1'000'000}, &Limits::max_iterations),
                   limit({"max-constraints", "N",
                          "Most entries of the options constraints, seam_edges, keep_edges and "
                          "locked_islands"},
                         {0, 10'000'000}, &Limits::max_constraints),
                   limit({"max-job-seconds", "N", "Most seconds of work on one job"},
                         {1, kMaxCount}, &Limits::max_job_seconds),
                   limit({"max-wait-seconds", "N",
                          "Most seconds that a request may wait by Prefer: wait"},
                         {0, 3600}, &Limits::max_wait_seconds),
                   limit({"max-queue", "N", "Most jobs that wait for a worker"}, {1, 1'000'000},
                         &Limits::max_queue),
                   limit({"max-streams", "N", "Most event streams open at once"}, {1, kMaxStreams},
                         &Limits::max_streams)}};
}

}  // namespace

std::vector<ConfigGroup> config_groups() {
  return {serving(), edge(), working(), storing(), admitting(), calling_out(), telling(), limits()};
}

void check_together(const Config& config) {
  if (shares_blobs(config) && config.database.url.empty())
    throw Error(ErrorCode::invalid_option,
                "--blobs is for nodes that share a --database; give its URL, too.");
  if (config.bucket.url.empty() && !config.bucket.endpoint.empty())
    throw Error(ErrorCode::invalid_option,
                "--s3-endpoint is of a bucket; give its name, too: --blobs s3://NAME.");
  if (config.bucket.url.empty() && config.bucket.redirects)
    throw Error(ErrorCode::invalid_option,
                "--blob-redirect sends clients to a bucket; give its name, too: --blobs "
                "s3://NAME.");
  if (!config.bucket.redirects && !config.bucket.redirect_endpoint.empty())
    throw Error(ErrorCode::invalid_option,
                "--blob-redirect-endpoint is of redirects; give --blob-redirect, too.");
  if (!config.serves && (!shares_blobs(config) || config.workers == 0))
    throw Error(
        ErrorCode::invalid_option,
        "A worker takes the jobs of other nodes; give it their --database and --blobs, and at "
        "least one of --workers.");
  if (config.workers == 0 && !shares_blobs(config))
    throw Error(ErrorCode::invalid_option,
                "--workers is 0 and no other node can run jobs; give --database and --blobs, or at "
                "least one worker.");
  if (config.edge.tls_cert.empty() != config.edge.tls_key.empty())
    throw Error(ErrorCode::invalid_option, "--tls-cert and --tls-key belong together; give both.");
  if (config.access.insecure && !config.access.key_file.empty())
    throw Error(ErrorCode::invalid_option, "--insecure and --key-file exclude each other.");
  if (config.admin && config.admin->port != 0 && *config.admin == config.listen) {
    throw Error(ErrorCode::invalid_option,
                "--admin-listen and --listen are the same address; give each its own.");
  }
}

}  // namespace unwrapd::server::config
