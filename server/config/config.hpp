#pragma once
// What one server is told: a table of options (config_table.cpp), each of which is a flag, an
// environment variable and a key of the file. --max-queue is UNWRAPD_MAX_QUEUE and max-queue; the
// flag wins over the variable, the variable over the file, the file over the default.

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "api/limits.hpp"
#include "server/access/access.hpp"
#include "server/base/log.hpp"
#include "server/blobs/disk_budget.hpp"
#include "server/bucket/bucket_config.hpp"
#include "server/database/postgres_address.hpp"
#include "server/http/addresses.hpp"
#include "server/sources/sources.hpp"
#include "server/webhooks/webhook_url.hpp"
#include "server/work/solver_cache.hpp"

namespace unwrapd::server::config {

/// Each job in a process of its own (job_process.hpp); automatic: where the kernel allows it.
enum class Isolate { off, automatic, on };

/// What clients may take of the HTTP edge, and how it is reached.
struct EdgeConfig {
  int max_requests = 64;       ///< answered at once, event streams not counted
  int max_connections = 4096;  ///< open at once
  int max_idle_connections = 1024;
  int max_connections_per_address = 256;  ///< 0: no limit
  std::vector<std::string> trusted_proxies;
  std::filesystem::path tls_cert;  ///< empty: plain HTTP
  std::filesystem::path tls_key;
};

struct Config {
  http::Address listen{"127.0.0.1", 8080};
  bool serves = true;  ///< false: works on jobs of other nodes, and listens for none
  EdgeConfig edge;
  /// Of the probes and metrics; without one there is none. parse_command_line() gives it the port
  /// after that of listen, on loopback, where nothing else is asked for.
  std::optional<http::Address> admin;
  std::filesystem::path data = "data";
  database::PostgresAddress database;  ///< without a URL: SQLite in data
  std::filesystem::path shared_blobs;  ///< of the files of all nodes; empty: in data, of this alone
  bucket::BucketConfig bucket;         ///< with a URL: that of the files of all nodes
  std::int64_t copied_bytes = 10'000'000'000;  ///< of the bucket's files, in data
  std::chrono::seconds lease{30};              ///< of a running job
  int workers = 1;
  int threads = 1;  ///< for each job
  int keep_seconds = 7 * 24 * 60 * 60;
  std::int64_t max_stored_jobs = 100'000;  ///< that have ended; 0: no limit
  int drain_seconds = 30;
  int grace_seconds = 5;  ///< for a job that was told to stop (worker_pool.hpp)
  Isolate isolate = Isolate::automatic;
  LogLevel log_level = LogLevel::info;
  LogFormat log_format = LogFormat::json;
  blobs::DiskLimits disk;
  access::AccessConfig access;
  std::vector<std::string> allowed_hosts;  ///< without keys, beside addresses and localhost
  std::vector<std::string> cors_origins;
  webhooks::WebhookConfig webhooks;
  sources::SourceConfig sources;
  work::MemoryLimits memory;
  api::Limits limits;
};

/// Whether several nodes may use the same files.
inline bool shares_blobs(const Config& config) {
  return !config.shared_blobs.empty() || !config.bucket.url.empty();
}

/// What the command line asks for.
enum class Task {
  serve,
  healthcheck,  ///< ask the server that runs with this configuration whether it is well
  leave,        ///< all has been said: --help, --version, --print-config, or a mistake
};

struct CommandLine {
  Task task = Task::leave;
  Config config;
  int exit_code = 0;  ///< of Task::leave; 2 after a mistake, of which stderr tells
};

/// What a file of options says; the rest is the default. Throws Error{invalid_option}.
Config config_of_file(const std::string& path);

/// `worker` as the first argument: the node only works.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace unwrapd::server::config
