#pragma once
// The command line of unwrapd. Every flag has an environment variable: --max-queue is
// UNWRAPD_MAX_QUEUE; the flag wins.

#include <filesystem>
#include <optional>
#include <string>

#include "api/limits.hpp"
#include "server/log.hpp"

namespace unwrapd::server {

struct Config {
  std::string host = "127.0.0.1";
  int port = 8080;  ///< 0: a free one
  std::filesystem::path data = "data";
  int workers = 1;
  int threads = 1;  ///< for each job
  int keep_seconds = 7 * 24 * 60 * 60;
  int drain_seconds = 30;
  LogLevel log_level = LogLevel::info;
  api::Limits limits;
};

/// What the command line asks for: to serve, or (--help, --version, a mistake) to exit, when all
/// has been printed.
struct CommandLine {
  std::optional<Config> config;
  int exit_code = 0;
};

CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace unwrapd::server
