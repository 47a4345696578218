#include "server/worker_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <functional>

#include "core/error.hpp"
#include "server/job_process.hpp"
#include "server/job_worker.hpp"

namespace unwrapd::server {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

[[noreturn]] void cannot_start() {
  throw Error(ErrorCode::internal,
              "A worker process cannot be started; check the limits of processes and files.");
}

/// What a new process begins with: the socket as its input, silence as its output, SIGTERM blocked
/// (its thread waits for it), a group of its own so that Ctrl-C reaches the server alone.
class SpawnPlan {
 public:
  explicit SpawnPlan(int socket) {
    posix_spawn_file_actions_init(&files_);
    posix_spawn_file_actions_adddup2(&files_, socket, STDIN_FILENO);
    for (const int silent : {STDOUT_FILENO, STDERR_FILENO})
      posix_spawn_file_actions_addopen(&files_, silent, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_init(&attributes_);
    sigset_t blocked;
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGTERM);
    posix_spawnattr_setsigmask(&attributes_, &blocked);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&files_);
    posix_spawnattr_destroy(&attributes_);
  }

  pid_t spawn(const std::string& program) const {
    std::string name = "unwrapd";
    std::string flag = kWorkerFlag;
    const std::array<char*, 3> arguments = {name.data(), flag.data(), nullptr};
    const std::array<char*, 1> environment = {nullptr};  // no secret of the server's
    pid_t process = -1;
    const int error = ::posix_spawn(&process, program.c_str(), &files_, &attributes_,
                                    arguments.data(), environment.data());
    return error == 0 ? process : -1;
  }

 private:
  posix_spawn_file_actions_t files_{};
  posix_spawnattr_t attributes_{};
};

/// How a process ended, in words.
std::string end_of(int status) {
  if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
  return "exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

WorkerProcess::WorkerProcess(const std::string& program, Stopping stopping)
    : stopping_(std::move(stopping)) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) cannot_start();
  socket_ = ends[0];
  stopped_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (stopped_ >= 0) process_ = SpawnPlan(ends[1]).spawn(program);
  ::close(ends[1]);
  if (process_ < 0) {
    ::close(socket_);
    ::close(stopped_);
    cannot_start();
  }
  on_stop_.emplace(stopping_.stop, [this] { ::eventfd_write(stopped_, 1); });
}

WorkerProcess::~WorkerProcess() {
  on_stop_.reset();
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  ::close(socket_);
  ::close(stopped_);
}

void WorkerProcess::ask_to_stop() {
  kill_at_ = Clock::now() + stopping_.grace;
  ::kill(process_, SIGTERM);
}

void WorkerProcess::kill_when_due() {
  if (!kill_at_ || killed_ || Clock::now() < *kill_at_) return;
  killed_ = true;
  ::kill(process_, SIGKILL);
  if (stopping_.on_kill) stopping_.on_kill();
}

/// What poll() waits at most: for ever, but between SIGTERM and SIGKILL.
int WorkerProcess::patience_ms() const {
  if (!kill_at_ || killed_) return -1;
  const auto left = std::chrono::ceil<milliseconds>(*kill_at_ - Clock::now()).count();
  return static_cast<int>(std::max<std::int64_t>(left, 0));
}

/// Waits until the socket is ready. The stop comes first: a worker whose socket is always ready
/// does not put it off.
void WorkerProcess::await(short events) {
  while (true) {
    std::array<pollfd, 2> polled = {pollfd{socket_, events, 0}, pollfd{stopped_, POLLIN, 0}};
    const int ready = ::poll(polled.data(), kill_at_ ? 1 : 2, patience_ms());
    if (ready > 0 && polled[1].revents != 0) ask_to_stop();
    kill_when_due();
    if (ready > 0 && polled[0].revents != 0) return;
  }
}

void WorkerProcess::send(std::string_view bytes) {
  while (!bytes.empty()) {
    await(POLLOUT);
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (sent < 0) reap();
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

bool WorkerProcess::receive(char* data, std::size_t size) {
  while (size > 0) {
    await(POLLIN);
    const ssize_t got = ::recv(socket_, data, size, MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (got <= 0) return false;
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

void WorkerProcess::reap() {
  int status = 0;
  ::kill(process_, SIGKILL);  // of no consequence to one that is ending already
  ::waitpid(process_, &status, 0);
  process_ = -1;
  if (kill_at_)
    throw Error(ErrorCode::cancelled, "The job was stopped; send it again to have it done.");
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    throw Error(ErrorCode::time_limit, "The job took more processor time than is allowed.");
  throw WorkerCrashed(end_of(status));
}

}  // namespace unwrapd::server
