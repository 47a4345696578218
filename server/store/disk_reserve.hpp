#pragma once
// Room that is kept on the disk for removing what is there: to remove a job, its row is written,
// and where nothing can be written nothing could be removed. A file of no content, which goes at
// the start (to open the store takes room, too) and when a removal finds the disk full, and is made
// again once there is room for it.

#include <cstdint>
#include <filesystem>
#include <mutex>

namespace unwrapd::server::store {

inline constexpr std::int64_t kReserveBytes = std::int64_t{1} << 20;

/// Thread-safe.
class DiskReserve {
 public:
  explicit DiskReserve(std::filesystem::path file) : file_(std::move(file)) { give_up(); }

  /// Where it is not there, and as much stays free beside it. Silent when it cannot.
  void make() noexcept;
  /// False when it was not there.
  bool give_up() noexcept;

 private:
  const std::filesystem::path file_;
  std::mutex mutex_;
};

}  // namespace unwrapd::server::store
