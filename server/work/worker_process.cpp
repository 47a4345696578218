#include "server/work/worker_process.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <functional>

#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/work/job_process.hpp"

namespace unwrapd::server::work {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Describes how a process ended.
std::string end_of(int status) {
  if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
  return "exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

WorkerProcess::WorkerProcess(StartedWorker worker, Stopping stopping)
    : worker_(std::move(worker)),
      stopping_(std::move(stopping)),
      stopped_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (stopped_ < 0)
    throw Error(ErrorCode::internal,
                "A worker process cannot be watched; check the limit of open files.");
  on_stop_.emplace(stopping_.stop, [this] { ::eventfd_write(stopped_, 1); });
}

WorkerProcess::~WorkerProcess() {
  on_stop_.reset();
  ::close(stopped_);
}

void WorkerProcess::ask_to_stop() {
  kill_at_ = Clock::now() + stopping_.grace;
  ::kill(worker_.process(), SIGTERM);
}

void WorkerProcess::kill_when_due() {
  if (!kill_at_ || killed_ || Clock::now() < *kill_at_) return;
  killed_ = true;
  ::kill(worker_.process(), SIGKILL);
  if (stopping_.on_kill) stopping_.on_kill();
}

/// The timeout of poll(): none, except between SIGTERM and SIGKILL.
int WorkerProcess::patience_ms() const {
  if (!kill_at_ || killed_) return -1;
  const auto left = std::chrono::ceil<milliseconds>(*kill_at_ - Clock::now()).count();
  return static_cast<int>(std::max<std::int64_t>(left, 0));
}

/// Waits until the socket is ready. A stop comes first: a worker whose socket is always ready does
/// not delay it.
void WorkerProcess::await(short events) {
  while (true) {
    std::array<pollfd, 2> polled = {pollfd{worker_.socket(), events, 0},
                                    pollfd{stopped_, POLLIN, 0}};
    const int ready = ::poll(polled.data(), kill_at_ ? 1 : 2, patience_ms());
    if (ready > 0 && polled[1].revents != 0) ask_to_stop();
    kill_when_due();
    if (ready > 0 && polled[0].revents != 0) return;
  }
}

void WorkerProcess::send(std::string_view bytes) {
  while (!bytes.empty()) {
    await(POLLOUT);
    const ssize_t sent =
        ::send(worker_.socket(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (sent < 0) reap();
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

bool WorkerProcess::receive(char* data, std::size_t size) {
  while (size > 0) {
    await(POLLIN);
    const ssize_t got = ::recv(worker_.socket(), data, size, MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (got <= 0) return false;
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

std::optional<StartedWorker> WorkerProcess::release() {
  on_stop_.reset();
  if (kill_at_) return std::nullopt;
  return std::move(worker_);
}

void WorkerProcess::reap() {
  const int status = worker_.end();
  if (kill_at_) throw job_stopped();
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    throw Error(ErrorCode::time_limit, "The job took more processor time than is allowed.");
  throw WorkerCrashed(end_of(status));
}

}  // namespace unwrapd::server::work
