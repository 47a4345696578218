#pragma once
// How much disk the jobs take, and how much they may. What has no room is refused before it is
// written. Uploads may fill three quarters of it: the last is for the results of jobs that are
// already accepted.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace unwrapd::server {

struct DiskLimits {
  std::int64_t max_bytes = 0;  ///< of all jobs' files; 0: no limit
  std::int64_t min_free_bytes = std::int64_t{16} * 1024 * 1024;  ///< that uploads leave on the disk
};

/// Thread-safe.
class DiskRoom {
 public:
  DiskRoom(std::filesystem::path folder, const DiskLimits& limits)
      : folder_(std::move(folder)), limits_(limits) {}

  /// evict() gives up the files of one finished job; false when there is none.
  void on_shortage(std::function<bool()> evict) { evict_ = std::move(evict); }

  /// Counts bytes that an upload is about to write. Throws Error{storage_full}.
  void take_for_upload(std::string_view job, std::int64_t bytes);
  /// Counts bytes of an accepted job's results. Throws Error{storage_full}.
  void take(std::string_view job, std::int64_t bytes);
  /// What a job's files take is now known to be this.
  void set(std::string_view job, std::int64_t bytes);
  void give_back(std::string_view job);

  [[nodiscard]] std::int64_t used_bytes() const;

 private:
  bool try_take(std::string_view job, std::int64_t bytes, std::int64_t limit);
  void take_below(std::string_view job, std::int64_t bytes, std::int64_t limit);

  const std::filesystem::path folder_;
  const DiskLimits limits_;
  std::function<bool()> evict_;
  mutable std::mutex mutex_;
  std::int64_t used_ = 0;
  std::map<std::string, std::int64_t, std::less<>> by_job_;
};

}  // namespace unwrapd::server
