#include "server/work/available_memory.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace unwrapd::server::work {

std::size_t memory_of_machine() {
  std::size_t bytes = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
                      static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (const char* path :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream limit(path);
    std::size_t most = 0;
    if (limit >> most) bytes = std::min(bytes, most);  // "max", or no such file: no limit
  }
  return bytes;
}

}  // namespace unwrapd::server::work
