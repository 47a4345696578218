#include "server/config.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <map>
#include <thread>

namespace unwrapd::server {
namespace {

constexpr std::int64_t kMaxBodyBytes = std::int64_t{4} * 1024 * 1024 * 1024;
constexpr int kMaxPort = 65535;
constexpr int kMaxThreads = 256;
constexpr int kMaxStreams = 4096;
constexpr int kMaxSeconds = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kMaxCount = std::numeric_limits<std::int32_t>::max();

/// "--max-queue" -> "UNWRAPD_MAX_QUEUE"
std::string environment_name(const std::string& flag) {
  std::string name = "UNWRAPD_" + flag.substr(2);
  for (char& letter : name)
    letter =
        letter == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  return name;
}

template <class Value>
CLI::Option* add(CLI::App& app, const std::string& flag, Value& value, const std::string& what) {
  return app.add_option(flag, value, what)->envname(environment_name(flag))->capture_default_str();
}

template <class Number>
void add_number(CLI::App& app, const std::string& flag, Number& value, const std::string& what,
                std::pair<Number, Number> range) {
  add(app, flag, value, what)->check(CLI::Range(range.first, range.second));
}

/// Splits "host:port" ("[::1]:8080" for IPv6). False when it is not of that form.
bool read_address(const std::string& text, Config& config) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return false;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + colon + 1, end, config.port);
  if (parsed.ec != std::errc() || parsed.ptr != end) return false;
  config.host = text.substr(0, colon);
  if (config.host.front() == '[' && config.host.back() == ']')
    config.host = config.host.substr(1, config.host.size() - 2);
  return config.port >= 0 && config.port <= kMaxPort;
}

void add_service_flags(CLI::App& app, Config& config) {
  add(app, "--data", config.data, "Directory of jobs and results; made when missing");
  add_number(app, "--workers", config.workers, "Jobs run at once", {1, kMaxThreads});
  add_number(app, "--threads", config.threads, "Threads of each job", {1, kMaxThreads});
  add_number(app, "--keep-seconds", config.keep_seconds, "How long results are kept",
             {1, kMaxSeconds});
  add_number(app, "--drain-seconds", config.drain_seconds,
             "How long running jobs may go on after SIGTERM", {0, kMaxSeconds});
  const std::map<std::string, LogLevel> levels = {{"debug", LogLevel::debug},
                                                  {"info", LogLevel::info},
                                                  {"warning", LogLevel::warning},
                                                  {"error", LogLevel::error},
                                                  {"off", LogLevel::off}};
  app.add_option("--log-level", config.log_level, "debug, info (default), warning, error or off")
      ->envname("UNWRAPD_LOG_LEVEL")
      ->transform(CLI::CheckedTransformer(levels).description(""));
}

void add_limit_flags(CLI::App& app, api::Limits& limits) {
  using Counts = std::pair<std::int64_t, std::int64_t>;
  add_number(app, "--max-body-bytes", limits.max_body_bytes, "Bytes of one request",
             Counts{1024, kMaxBodyBytes});
  add_number(app, "--max-vertices", limits.max_vertices, "Vertices of an asset",
             Counts{3, kMaxCount});
  add_number(app, "--max-faces", limits.max_faces, "Triangles of an asset", Counts{1, kMaxCount});
  add_number(app, "--max-sync-faces", limits.max_sync_faces,
             "Triangles of an asset sent to /v1/unwrap", Counts{1, kMaxCount});
  add_number(app, "--max-iterations", limits.max_iterations,
             "The options stop.iterations and stop.max_iterations", {1, 1'000'000});
  add_number(app, "--max-constraints", limits.max_constraints, "Entries of the option constraints",
             {0, 10'000'000});
  add_number(app, "--max-job-seconds", limits.max_job_seconds, "Work on one job", {1, kMaxSeconds});
  add_number(app, "--max-wait-seconds", limits.max_wait_seconds, "Prefer: wait", {0, 3600});
  add_number(app, "--max-queue", limits.max_queue, "Jobs that wait for a worker", {1, 1'000'000});
  add_number(app, "--max-streams", limits.max_streams, "Event streams open at once",
             {1, kMaxStreams});
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  Config config;
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  config.threads = std::min(2, cores);
  config.workers = cores / config.threads;

  CLI::App app(
      "Gives triangle meshes their UVs, over HTTP. Every flag can be given as an "
      "environment variable as well: --max-queue is UNWRAPD_MAX_QUEUE.",
      "unwrapd");
  app.set_version_flag("--version", "unwrapd " UNWRAPD_VERSION);
  std::string listen = "127.0.0.1:8080";
  add(app, "--listen", listen, "HOST:PORT; port 0 takes a free one")
      ->check([&](const std::string& text) {
        return read_address(text, config) ? std::string() : "--listen takes HOST:PORT";
      });
  add_service_flags(app, config);
  add_limit_flags(app, config.limits);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return {.config = std::nullopt, .exit_code = app.exit(error)};
  }
  return {.config = config, .exit_code = 0};
}

}  // namespace unwrapd::server
