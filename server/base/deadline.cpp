#include "server/base/deadline.hpp"

#include <utility>

namespace unwrapd::server {

Deadline::Deadline(std::chrono::seconds time, std::function<void()> late)
    : watch_([this, time, late = std::move(late)](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, stop, time, [] { return false; });
        if (!stop.stop_requested()) late();
      }) {}

}  // namespace unwrapd::server
