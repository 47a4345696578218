#include "core/solve/kept.hpp"

#include <cmath>
#include <string>

#include "core/error.hpp"

namespace unwrapd {

namespace {

/// That a job on a disk takes beside its factor: positions, rest triangles, maps, what was read and
/// what is written (measured: 600 to 800 at 100k to 1M faces).
constexpr std::size_t kBytesPerFace = 800;

}  // namespace

void check_memory(const Disk& disk, std::size_t bytes) {
  if (disk.core != nullptr) check_memory(*disk.core, kBytesPerFace * disk.faces.size() + bytes);
}

}  // namespace unwrapd
