#include "server/base/threads.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <exception>
#include <utility>

#include "server/base/errors.hpp"

namespace unwrapd::server {
namespace {

constexpr int kNice = 10;  // a tenth of the time that other threads get, on a busy machine

}  // namespace

Periodic::Periodic(const std::string& name, std::chrono::milliseconds pause,
                   std::function<void()> action, const Log& log)
    : thread_([this, name, pause, action = std::move(action), &log](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
          try {
            action();
          } catch (const std::exception& error) {
            log.error(name + " failed", {{"reason", reason_of(error)}});
          }
          wake_.wait_for(lock, stop, pause, [] { return false; });
        }
      }) {}

Deadline::Deadline(std::chrono::seconds time, std::function<void()> late)
    : watch_([this, time, late = std::move(late)](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, stop, time, [] { return false; });
        if (!stop.stop_requested()) late();
      }) {}

void give_way() {
  const auto self = static_cast<id_t>(::gettid());
  ::setpriority(PRIO_PROCESS, self, ::getpriority(PRIO_PROCESS, self) + kNice);
}

}  // namespace unwrapd::server
