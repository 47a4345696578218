#include "core/base/shared_cache.hpp"

#include <string>

#include "core/base/error.hpp"

namespace unwrapd {
namespace {

std::string megabytes(std::size_t bytes) {
  return std::to_string((bytes + 999'999) / 1'000'000) + " MB";
}

}  // namespace

void check_memory(std::size_t bytes, std::size_t limit) {
  if (bytes <= limit) return;
  throw Error(ErrorCode::too_much_memory,
              "The job would take about " + megabytes(bytes) +
                  " of memory, and no job may take more than " + megabytes(limit) +
                  " here; send fewer faces, or cut the mesh into charts.");
}

}  // namespace unwrapd
