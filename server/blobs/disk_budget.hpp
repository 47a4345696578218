#pragma once
// How much disk the jobs take, and how much they may take. A file without room is refused before it
// is written. Uploads may fill three quarters of the room; the last quarter is for the results of
// accepted jobs. Older results are removed for an upload only if it then has room. On a disk that
// is full, what is in DIR/lost is given up first.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace unwrapd::server::blobs {

struct DiskLimits {
  std::int64_t max_bytes = 0;  ///< of all jobs' files; 0: no limit
  std::int64_t min_free_bytes =
      std::int64_t{16} * 1024 * 1024;  ///< that uploads leave on the disk, and results half of it
};

/// What can be given up where there is no room.
struct Evictions {
  std::function<bool()> evict;          ///< the files of one finished job; false when there is none
  std::function<std::int64_t()> bytes;  ///< of all that evict() would give up
  std::function<bool()> give_up_lost = {};  ///< one folder of DIR/lost; false when there is none
};

/// Size of the reserve.
inline constexpr std::int64_t kReserveBytes = std::int64_t{1} << 20;

/// A file without content that keeps room on the disk. To remove a job, its row is written first;
/// on a disk where nothing can be written, nothing could be removed. The file is removed at the
/// start (opening the store takes room, too) and when a removal finds the disk full. It is made
/// again once there is room. Thread-safe.
class DiskReserve {
 public:
  explicit DiskReserve(std::filesystem::path file) : file_(std::move(file)) { give_up(); }

  /// Makes the file if it is missing and as much stays free beside it. Fails silently.
  void make() noexcept;
  /// Removes the file. False when there was none.
  bool give_up() noexcept;

 private:
  const std::filesystem::path file_;
  std::mutex mutex_;
};

/// Thread-safe.
class DiskBudget {
 public:
  DiskBudget(std::filesystem::path folder, const DiskLimits& limits)
      : folder_(std::move(folder)), limits_(limits), reserve_(folder_ / "reserve") {}

  void on_shortage(Evictions evictions) { evictions_ = std::move(evictions); }

  /// Throws Error{storage_full} for an upload of so many bytes that can never fit.
  void check_upload(std::int64_t bytes) const;
  /// Counts bytes that an upload is about to write. False when that takes giving something up.
  /// Throws Error{storage_full} when the disk is full.
  [[nodiscard]] bool try_take_for_upload(std::string_view job, std::int64_t bytes);
  /// The same, giving up what it takes; whole: all that the upload will have, as far as is known,
  /// these included. Throws Error{storage_full}, and nothing is given up, when there is no room for
  /// the whole.
  void take_for_upload(std::string_view job, std::int64_t bytes, std::int64_t whole);
  /// Counts bytes of an accepted job's results. Throws Error{storage_full}.
  void take(std::string_view job, std::int64_t bytes);
  /// Counts bytes of what can be made again at any time: nothing is given up for it. False when
  /// there is no room.
  [[nodiscard]] bool try_take(std::string_view job, std::int64_t bytes);
  /// Bytes that were taken, and could not be written.
  void put_back(std::string_view job, std::int64_t bytes);
  /// Throws Error{storage_full} when the disk has no room for so many bytes.
  void check_free(std::int64_t bytes) const;
  /// What a job's files take is now known to be this.
  void set(std::string_view job, std::int64_t bytes);
  void give_back(std::string_view job);
  /// What all files take that are stored, where other nodes store files, too. Uploads and results
  /// that are being written are counted from then on.
  void recount(std::int64_t bytes);

  /// Writes what says that something is removed: on a full disk, in the room kept for that. May
  /// call it twice. Throws what it throws.
  void free_by(const std::function<void()>& write);
  /// Keeps that room again, if there is some.
  void make_reserve() noexcept { reserve_.make(); }

  [[nodiscard]] std::int64_t used_bytes() const;

 private:
  [[nodiscard]] std::int64_t upload_limit() const;
  [[nodiscard]] bool is_free(std::int64_t bytes, std::int64_t left_free) const;
  void free_on_disk(std::int64_t bytes, std::int64_t left_free);
  void check_evictions(std::string_view job, std::int64_t whole) const;
  bool try_take(std::string_view job, std::int64_t bytes, std::int64_t limit);
  void take_below(std::string_view job, std::int64_t bytes, std::int64_t limit);

  const std::filesystem::path folder_;
  const DiskLimits limits_;
  DiskReserve reserve_;
  Evictions evictions_;
  mutable std::mutex mutex_;
  std::int64_t used_ = 0;
  std::map<std::string, std::int64_t, std::less<>> by_job_;
};

}  // namespace unwrapd::server::blobs
