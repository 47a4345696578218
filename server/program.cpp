#include "server/program.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <string_view>
#include <thread>

#include "server/backup/backup_command.hpp"
#include "server/base/errors.hpp"
#include "server/base/log.hpp"
#include "server/config/component_config.hpp"
#include "server/config/config.hpp"
#include "server/http/http_probe.hpp"
#include "server/keys_command.hpp"
#include "server/service.hpp"
#include "server/work/job_worker.hpp"

namespace unwrapd::server {
namespace {

constexpr mode_t kNotOfOthers = 0027;                           // meshes, results and the databases
constexpr rlim_t kManyFiles = 1'000'000'000;                    // as good as no limit
constexpr timespec kLook{.tv_sec = 0, .tv_nsec = 200'000'000};  // for a second signal

/// Raises the limit of open files as far as the kernel allows, as the default is less than --max-
/// connections. Returns the configuration with as many connections as that leaves room for.
config::Config with_open_files(config::Config config, const Log& log) {
  rlimit files{};
  ::getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &files);
  const auto most = static_cast<std::int64_t>(std::min<rlim_t>(files.rlim_max, kManyFiles));
  const int connections = config::connections_within(most, config);
  if (connections < config.edge.max_connections)
    log.warning("fewer connections than --max-connections: few files may be open",
                {{"connections", connections}, {"files", most}});
  config.edge.max_connections = connections;
  config.edge.max_idle_connections = std::min(config.edge.max_idle_connections, connections / 2);
  return config;
}

bool has_terminal() { return ::isatty(STDIN_FILENO) != 0 || ::isatty(STDERR_FILENO) != 0; }

/// The signals that end the server, blocked in this thread and all that it starts from now on.
sigset_t block_end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  if (has_terminal()) {
    sigaddset(&signals, SIGHUP);  // the terminal is gone
  } else {
    std::signal(SIGHUP, SIG_IGN);  // what asks a daemon to read its configuration must not end it
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

/// At a second signal, running jobs get no more time.
std::jthread stop_waiting_at_next(const sigset_t& signals, Service& service, const Log& log) {
  return std::jthread([signals, &service, &log](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (::sigtimedwait(&signals, nullptr, &kLook) < 0) continue;
      log.info("stopping without waiting for jobs");
      service.stop_waiting();
      return;
    }
  });
}

void serve(const config::Config& config, const Log& log, const work::WorkerFunctions& functions) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond `ulimit -f` is then EFBIG, as no room is ENOSPC
  const sigset_t signals = block_end_signals();
  Service service(config, log, functions);
  if (config.serves) {
    const std::string address = http::to_text({config.listen.host, service.port()});
    const char* scheme = config.edge.tls_cert.empty() ? "http" : "https";
    std::printf("unwrapd listening on %s://%s\n", scheme, address.c_str());
  } else {
    std::printf("unwrapd works on the jobs of other nodes\n");
  }
  if (service.admin_port()) {
    const std::string admin = http::to_text({config.admin->host, *service.admin_port()});
    std::printf("unwrapd admin port on http://%s\n", admin.c_str());
  }
  std::fflush(stdout);
  int signal = 0;
  sigwait(&signals, &signal);
  log.info("draining", {{"signal", signal}});
  const std::jthread watching = stop_waiting_at_next(signals, service, log);
  if (!service.drain()) {
    log.warning("ended although jobs did not stop");
    std::_Exit(EXIT_SUCCESS);  // without their threads; what they do is no longer wanted
  }
  log.info("drained");
}

}  // namespace

int run_program(int argc, char** argv, work::WorkerFunctions functions) {
  ::umask(kNotOfOthers);
  if (work::is_job_worker(argc, argv)) return work::run_job_worker(functions);
  if (argc > 1 && std::string_view(argv[1]) == "keys") return run_keys_command(argc, argv);
  if (argc > 1 && backup::is_backup_command(argv[1])) return backup::run_backup_command(argc, argv);
  const config::CommandLine line = config::parse_command_line(argc, argv);
  if (line.task == config::Task::leave) return line.exit_code;
  if (line.task == config::Task::healthcheck) return http::probe(*line.config.admin);
  const Log log(line.config.log_level, line.config.log_format);
  try {
    if (functions.program.empty()) functions.program = "/proc/self/exe";
    serve(with_open_files(line.config, log), log, functions);
    return 0;
  } catch (const std::exception& error) {
    log.error("unwrapd cannot run",
              {{"reason", reason_of(error)}, {"data", line.config.data.string()}});
    return 1;
  }
}

}  // namespace unwrapd::server
