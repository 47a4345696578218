#include "server/base/wakeup.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace unwrapd::server {

Wakeup::Wakeup() : descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (descriptor_ < 0)
    throw Error(ErrorCode::internal,
                "No file descriptor is left; allow more open files (ulimit -n).");
}

Wakeup::~Wakeup() { ::close(descriptor_); }

void Wakeup::ring() const { ::eventfd_write(descriptor_, 1); }

void Wakeup::answer() const {
  eventfd_t rings = 0;
  ::eventfd_read(descriptor_, &rings);
}

}  // namespace unwrapd::server
