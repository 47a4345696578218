#include "server/http/epoll.hpp"

#include <unistd.h>

#include <algorithm>

namespace unwrapd::server::http {

Epoll::Epoll() : epoll_(::epoll_create1(EPOLL_CLOEXEC)) {}

Epoll::~Epoll() { ::close(epoll_); }

std::span<const epoll_event> Epoll::wait(int patience_ms) {
  const int count =
      ::epoll_wait(epoll_, ready_.data(), static_cast<int>(ready_.size()), patience_ms);
  return {ready_.data(), static_cast<std::size_t>(std::max(count, 0))};
}

void Epoll::control(int operation, int descriptor, short events) const {
  epoll_event event{};
  event.events = static_cast<unsigned short>(events);
  event.data.fd = descriptor;
  ::epoll_ctl(epoll_, operation, descriptor, &event);
}

}  // namespace unwrapd::server::http
