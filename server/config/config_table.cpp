// The one place where options of the server are declared: name, range and sentence of each.
#include <algorithm>
#include <limits>

#include "server/config/config_row.hpp"
#include "server/http/addresses.hpp"

namespace unwrapd::server {
namespace {

constexpr std::int64_t kMaxBodyBytes = std::int64_t{4} * 1024 * 1024 * 1024;
constexpr std::int64_t kMaxDiskBytes = std::int64_t{1} << 60;
constexpr std::int64_t kMaxMemoryBytes = std::int64_t{1} << 60;
constexpr int kMaxThreads = 256;
constexpr int kMaxStreams = 4096;
constexpr std::int64_t kMaxCount = std::numeric_limits<std::int32_t>::max();
constexpr std::string_view kNoAdmin = "off";

Address address_of(const std::string& text) {
  const std::optional<Address> address = parse_address(text);
  if (!address) expected("HOST:PORT with a port from 0 to 65535");
  return *address;
}

ConfigRow listen_row() {
  return {.heading = {"listen", "HOST:PORT", "Where to serve; port 0 takes a free one"},
          .kind = ConfigKind::text,
          .set = [](Config& config, const std::string& text) { config.listen = address_of(text); },
          .get = [](const Config& config) { return to_text(config.listen); }};
}

ConfigRow admin_row() {
  return {.heading = {"admin-listen", "HOST:PORT",
                      "Where to serve probes and metrics, or off; not given: 127.0.0.1 and the "
                      "port after that of --listen"},
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

void check_range(const std::string& item) { const AddressSet set({item}); }

ConfigGroup edge() {
  using E = EdgeConfig;
  const auto edge = &Config::edge;
  return {
      .title = "Edge",
      .rows = {
          number({"max-connections", "N",
                  "Connections open at once, fewer where few files may be open; more are turned "
                  "away"},
                 {16, 1'000'000}, edge, &E::max_connections),
          number({"max-idle-connections", "N",
                  "Of those, ones that send nothing; one more drives out the longest"},
                 {1, 1'000'000}, edge, &E::max_idle_connections),
          number({"max-connections-per-address", "N",
                  "Of one client, an IPv6 one by its /64; loopback and trusted proxies are not "
                  "counted; 0: no limit"},
                 {0, 1'000'000}, edge, &E::max_connections_per_address),
          number(
              {"max-requests", "N",
               "Requests answered at once; event streams, and half as many that wait for jobs or "
               "pictures, come on top"},
              {1, 4096}, edge, &E::max_requests),
          list({"trusted-proxies", "RANGES",
                "Addresses and ranges (10.0.0.0/8,::1) whose X-Forwarded-For is believed"},
               check_range, edge, &E::trusted_proxies),
          text({"tls-cert", "PATH", "PEM file of the certificate and its chain; HTTPS then"}, edge,
               &E::tls_cert),
          text({"tls-key", "PATH", "PEM file of its key"}, edge, &E::tls_key)}};
}

/// true and false are on and off, which is what the option once was.
ConfigRow isolate_row() {
  ConfigRow row = choice(
      {"isolate", "",
       "Each job in a process of its own, without files or network: a crash "
       "costs that job alone; --isolate=auto (where the kernel allows it), on "
       "or off"},
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
      .title = "Working",
      .rows = {
          text({"data", "PATH", "Directory of jobs and results; made when missing"}, &Config::data),
          number({"workers", "N", "Jobs run at once"}, {1, kMaxThreads}, &Config::workers),
          number({"threads", "N", "Threads of each job"}, {1, kMaxThreads}, &Config::threads),
          number({"memory-limit", "N",
                  "Bytes that one job may take: what would need more is refused; 0: its share of "
                  "the machine"},
                 {0, kMaxMemoryBytes}, &Config::memory, &MemoryLimits::job_bytes),
          number({"solver-cache-bytes", "N",
                  "Factors and maps kept for further jobs on the same mesh"},
                 {0, kMaxMemoryBytes}, &Config::memory, &MemoryLimits::cache_bytes),
          isolate_row(),
          number({"grace-seconds", "N",
                  "How long a job that was told to stop, by --max-job-seconds or its owner, may go "
                  "on; then its process is killed, or its thread given up"},
                 {0, 3600}, &Config::grace_seconds),
          number({"drain-seconds", "N",
                  "How long running jobs may go on after SIGTERM, or until a second one; jobs that "
                  "do not stop and last answers may take 15 s and --grace-seconds more"},
                 {0, kMaxCount}, &Config::drain_seconds)}};
}

ConfigGroup storing() {
  return {.title = "Storing",
          .rows = {number({"keep-seconds", "N", "How long results are kept"}, {1, kMaxCount},
                          &Config::keep_seconds),
                   number({"max-stored-jobs", "N",
                           "Ended jobs of which anything is known; beyond it expired ones go, then "
                           "the oldest of the key that has the most; 0: no limit"},
                          {0, kMaxCount}, &Config::max_stored_jobs),
                   number({"max-disk-bytes", "N",
                           "Files of all jobs; results that ended first go earlier to keep within "
                           "it; 0: no limit"},
                          {0, kMaxDiskBytes}, &Config::disk, &DiskLimits::max_bytes),
                   number({"min-free-bytes", "N",
                           "Uploads leave so much of the disk free, results half"},
                          {0, kMaxDiskBytes}, &Config::disk, &DiskLimits::min_free_bytes)}};
}

/// Browsers send origins, and webhooks' hosts are compared, in small letters.
bool has_capital(const std::string& text) {
  return std::ranges::any_of(text, [](char c) { return c >= 'A' && c <= 'Z'; });
}

/// "https://example.com", without a path, as browsers write it.
void check_origin(const std::string& item) {
  const std::size_t scheme = item.find("://");
  const bool whole = scheme != std::string::npos && item.size() > scheme + 3 &&
                     item.find_first_of("/*", scheme + 3) == std::string::npos;
  if (item != "*" && (!whole || has_capital(item)))
    expected("origins like https://example.com, in small letters, or *");
}

void check_host(const std::string& item) {
  const std::string host = item.starts_with("*.") ? item.substr(2) : item;
  const bool whole = !host.empty() && host.find_first_of("*/:@? ") == std::string::npos;
  if (item != "*" && (!whole || has_capital(item)))
    expected("hosts like example.com or *.example.com, in small letters, or *");
}

ConfigGroup admitting() {
  return {
      .title = "Admitting",
      .rows = {on_off({"require-keys", "", "Ask for API keys on loopback, too"}, &Config::access,
                      &AccessConfig::require_keys),
               text({"key-file", "PATH",
                     "File of a key of the operator's own, 32 characters or more, of the scope "
                     "admin: a mounted secret"},
                    &Config::access, &AccessConfig::key_file),
               on_off({"insecure", "", "Ask for no API keys although other machines can connect"},
                      &Config::access, &AccessConfig::insecure),
               list({"allowed-hosts", "LIST",
                     "Names by which the server is reached where it asks for no keys: "
                     "example.com, *.example.com or *; addresses and localhost always are"},
                    check_host, &Config::allowed_hosts),
               list({"cors-origins", "LIST", "Sites whose pages may call from a browser, or *"},
                    check_origin, &Config::cors_origins),
               list({"webhook-hosts", "LIST",
                     "Hosts that webhooks may call: example.com, *.example.com or *"},
                    check_host, &Config::webhooks, &WebhookConfig::allowed_hosts),
               on_off({"webhook-private", "",
                       "Let webhooks call addresses of this machine and of private networks"},
                      &Config::webhooks, &WebhookConfig::allow_private),
               number({"webhook-retry-seconds", "N",
                       "Until the second try of a webhook, doubled for each further one"},
                      {1, 3600}, &Config::webhooks, &WebhookConfig::retry_seconds)}};
}

ConfigGroup telling() {
  const Names<LogLevel> levels = {{"debug", LogLevel::debug},
                                  {"info", LogLevel::info},
                                  {"warning", LogLevel::warning},
                                  {"error", LogLevel::error},
                                  {"off", LogLevel::off}};
  const Names<LogFormat> formats = {{"json", LogFormat::json}, {"text", LogFormat::text}};
  return {.title = "Telling",
          .rows = {choice({"log-level", "LEVEL", "debug, info, warning, error or off"}, levels,
                          &Config::log_level),
                   choice({"log-format", "FORMAT", "json or text"}, formats, &Config::log_format)}};
}

template <class Number>
ConfigRow limit(const ConfigHeading& heading, Range range, Number api::Limits::*limit) {
  return number(heading, range, &Config::limits, limit);
}

ConfigGroup limits() {
  using api::Limits;
  return {
      .title = "Limits",
      .rows = {
          limit({"max-body-bytes", "N", "Bytes of one request"}, {1024, kMaxBodyBytes},
                &Limits::max_body_bytes),
          limit({"max-vertices", "N", "Vertices of an asset"}, {3, kMaxCount},
                &Limits::max_vertices),
          limit({"max-faces", "N", "Triangles of an asset"}, {1, kMaxCount}, &Limits::max_faces),
          limit({"max-sync-faces", "N", "Triangles of an asset sent to /v1/unwrap"}, {1, kMaxCount},
                &Limits::max_sync_faces),
          limit({"max-iterations", "N", "The options stop.iterations and stop.max_iterations"},
                {1, 1'000'000}, &Limits::max_iterations),
          limit({"max-constraints", "N", "Entries of the option constraints"}, {0, 10'000'000},
                &Limits::max_constraints),
          limit({"max-job-seconds", "N", "Work on one job"}, {1, kMaxCount},
                &Limits::max_job_seconds),
          limit({"max-wait-seconds", "N", "Prefer: wait"}, {0, 3600}, &Limits::max_wait_seconds),
          limit({"max-queue", "N", "Jobs that wait for a worker"}, {1, 1'000'000},
                &Limits::max_queue),
          limit({"max-streams", "N", "Event streams open at once"}, {1, kMaxStreams},
                &Limits::max_streams)}};
}

}  // namespace

std::vector<ConfigGroup> config_groups() {
  return {serving(), edge(), working(), storing(), admitting(), telling(), limits()};
}

void check_together(const Config& config) {
  if (config.edge.tls_cert.empty() != config.edge.tls_key.empty())
    throw Error(ErrorCode::invalid_option, "--tls-cert and --tls-key go together; give both.");
  if (config.access.insecure && !config.access.key_file.empty())
    throw Error(ErrorCode::invalid_option, "--insecure and --key-file exclude each other.");
  if (config.admin && config.admin->port != 0 && *config.admin == config.listen) {
    throw Error(ErrorCode::invalid_option,
                "--admin-listen and --listen are the same address; give them two.");
  }
}

}  // namespace unwrapd::server
