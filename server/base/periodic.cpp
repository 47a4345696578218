#include "server/base/periodic.hpp"

#include <exception>

#include "server/base/inside_error.hpp"

namespace unwrapd::server {

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

}  // namespace unwrapd::server
