#include "server/work/started_worker.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <utility>

#include "core/base/error.hpp"
#include "server/work/job_worker.hpp"

namespace unwrapd::server::work {
namespace {

/// The environment of the heap. A server's heap has its pages, but those of a new process are added
/// one fault after another: they were most of the cost of isolation for a job of 20,000 faces (ADR
/// 0037). So the heap grows by huge pages, many at a time, and returns nothing before the process
/// ends. A kernel without huge pages, or a C library that does not know these settings, ignores
/// them.
constexpr const char* kHeap =
    "GLIBC_TUNABLES=glibc.malloc.hugetlb=1:glibc.malloc.top_pad=67108864:"
    "glibc.malloc.mmap_threshold=33554432:glibc.malloc.trim_threshold=2147483647";

[[noreturn]] void cannot_start() {
  throw Error(ErrorCode::internal,
              "A worker process cannot be started; check the limits of processes and files.");
}

/// The state of a new process: the socket as its input, no output, SIGTERM blocked (its thread
/// waits for it), a process group of its own so that Ctrl-C reaches only the server.
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
    std::string heap = kHeap;
    const std::array<char*, 3> arguments = {name.data(), flag.data(), nullptr};
    const std::array<char*, 2> environment = {heap.data(), nullptr};  // no secret of the server's
    pid_t process = -1;
    const int error = ::posix_spawn(&process, program.c_str(), &files_, &attributes_,
                                    arguments.data(), environment.data());
    return error == 0 ? process : -1;
  }

 private:
  posix_spawn_file_actions_t files_{};
  posix_spawnattr_t attributes_{};
};

}  // namespace

StartedWorker::StartedWorker(const std::string& program, const SandboxLimits& limits) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) cannot_start();
  socket_ = ends[0];
  process_ = SpawnPlan(ends[1]).spawn(program);
  ::close(ends[1]);
  if (process_ < 0) {
    ::close(socket_);
    cannot_start();
  }
  static_cast<void>(  // they fit in any buffer; that it has ended already shows when it is asked
      !::send(socket_, &limits, sizeof limits, MSG_NOSIGNAL | MSG_DONTWAIT));
}

StartedWorker::StartedWorker(StartedWorker&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      process_(std::exchange(other.process_, -1)),
      is_lasting_(other.is_lasting_),
      worked_(other.worked_) {}

StartedWorker::~StartedWorker() {
  if (process_ > 0) end();
  if (socket_ >= 0) ::close(socket_);
}

std::optional<std::int64_t> StartedWorker::held_bytes() const {
  std::ifstream statm("/proc/" + std::to_string(process_) + "/statm");
  std::int64_t all = 0, resident = 0;
  if (!(statm >> all >> resident)) return std::nullopt;
  return resident * ::sysconf(_SC_PAGESIZE);
}

int StartedWorker::end() {
  int status = 0;
  ::kill(process_, SIGKILL);  // of no consequence to one that is ending already
  ::waitpid(process_, &status, 0);
  process_ = -1;
  return status;
}

}  // namespace unwrapd::server::work
