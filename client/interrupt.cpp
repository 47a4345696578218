// A signal handler could only set a global flag, which a blocked read does not see. Instead the
// signals are blocked, and a thread reads them from a descriptor; it may call any function.
#include "client/interrupt.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <tuple>

namespace unwrapd::client {
namespace {

/// Whether the signal was ignored when the program started, as nohup does with SIGHUP.
bool is_ignored(int signal) {
  struct sigaction now {};
  return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace

Interrupt::Interrupt(std::chrono::milliseconds time_limit) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (!is_ignored(signal)) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signals_ = signalfd(-1, &signals, SFD_CLOEXEC);
  finish_ = eventfd(0, EFD_CLOEXEC);
  watcher_ = std::jthread([this, time_limit] { watch(time_limit); });
}

Interrupt::~Interrupt() {
  eventfd_write(finish_, 1);
  watcher_.join();
  close(signals_);
  close(finish_);
}

void Interrupt::watch(std::chrono::milliseconds time_limit) {
  std::array<pollfd, 2> sources{{{signals_, POLLIN, 0}, {finish_, POLLIN, 0}}};
  const int timeout_ms = time_limit.count() > 0 ? static_cast<int>(time_limit.count()) : -1;
  const int ready = poll(sources.data(), sources.size(), timeout_ms);
  if (sources[1].revents != 0) return;
  signalfd_siginfo taken{};  // must be read, else the signal stays pending
  if (sources[0].revents != 0) std::ignore = read(signals_, &taken, sizeof taken);
  timed_out_ = ready == 0;
  source_.request_stop();
}

}  // namespace unwrapd::client
