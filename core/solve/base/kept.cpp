#include "core/solve/base/kept.hpp"

#include <cmath>
#include <string>

#include "core/base/error.hpp"

namespace unwrapd {

void check_memory(const Disk& disk, std::size_t bytes) {
  if (disk.core != nullptr)
    check_memory(kJobBytesPerFace * disk.faces.size() + bytes, disk.core->memory_limit());
}

}  // namespace unwrapd
