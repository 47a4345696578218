#include "server/base/priority.hpp"

#include <sys/resource.h>
#include <unistd.h>

namespace unwrapd::server {
namespace {

constexpr int kNice = 10;  // more than others: a tenth of their time where they want it all

}  // namespace

void give_way() {
  const auto self = static_cast<id_t>(::gettid());
  ::setpriority(PRIO_PROCESS, self, ::getpriority(PRIO_PROCESS, self) + kNice);
}

}  // namespace unwrapd::server
