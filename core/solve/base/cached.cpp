#include "core/solve/base/cached.hpp"

#include <cmath>
#include <string>

#include "core/base/error.hpp"

namespace unwrapd::solve {

void check_memory(const Disk& disk, std::size_t bytes) {
  if (disk.core != nullptr)
    unwrapd::check_memory(kJobBytesPerFace * disk.faces.size() + bytes, disk.core->memory_limit());
}

}  // namespace unwrapd::solve
