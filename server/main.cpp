// unwrapd: reads its command line, serves until SIGTERM or SIGINT, drains, exits with 0.

#include <pthread.h>

#include <csignal>
#include <cstdio>
#include <exception>

#include "server/config.hpp"
#include "server/log.hpp"
#include "server/service.hpp"

namespace {

/// The signals that end the server, blocked in this thread and all that it starts from now on.
sigset_t block_end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

void run(const unwrapd::server::Config& config, const unwrapd::server::Log& log) {
  const sigset_t signals = block_end_signals();
  unwrapd::server::Service service(config, log);
  const bool is_ipv6 = config.host.find(':') != std::string::npos;
  const std::string host = is_ipv6 ? "[" + config.host + "]" : config.host;
  std::printf("unwrapd listening on http://%s:%d\n", host.c_str(), service.port());
  std::fflush(stdout);
  int signal = 0;
  sigwait(&signals, &signal);
  log.info("draining", {{"signal", signal}});
  service.drain();
  log.info("drained");
}

}  // namespace

int main(int argc, char** argv) {
  const auto line = unwrapd::server::parse_command_line(argc, argv);
  if (!line.config) return line.exit_code;
  const unwrapd::server::Log log(line.config->log_level);
  try {
    run(*line.config, log);
    return 0;
  } catch (const std::exception& error) {
    log.error("unwrapd cannot run", {{"reason", error.what()}});
    return 1;
  }
}
