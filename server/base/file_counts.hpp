#pragma once
// What a store of files that are made when somebody asks counts of itself, since the start.

#include <atomic>
#include <cstdint>
#include <string_view>

namespace unwrapd::server {

/// Thread-safe.
struct FileCounts {
  std::atomic<std::uint64_t> hits = 0;    ///< the file was there
  std::atomic<std::uint64_t> misses = 0;  ///< it was made
  std::atomic<std::uint64_t> bytes = 0;   ///< of those that were made

  void made(std::string_view file) {
    ++misses;
    bytes += file.size();
  }
};

}  // namespace unwrapd::server
