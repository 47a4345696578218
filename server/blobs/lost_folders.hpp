#pragma once
// DIR/lost: what was found in DIR/blobs at a start and belongs to no row that can be read. The
// database may be older than the files (a copy put back, a WAL that was cut off), and then these
// are results which only the newer one knows: put that back, start again, and they return to blobs.
// Else they go after the time that results are kept, or as the first when room is needed, be it of
// --max-disk-bytes or of the disk. Nothing comes here but by a move, so the folder never makes more
// of what is stored.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "server/blobs/disk_budget.hpp"

namespace unwrapd::server::blobs {

/// Thread-safe. Times are of Moment::kept_ms(); a folder's time is its own modification time.
class LostFolders {
 public:
  LostFolders(const std::filesystem::path& data, DiskBudget& room)
      : blobs_(data / "blobs"), lost_(data / "lost"), room_(room) {}

  /// Counts what is there, and moves those that are wanted back to blobs; returns how many.
  int return_wanted(const std::function<bool(const std::string& name)>& wanted);
  /// Moves a folder, or what is in a folder's place, from blobs. Throws Error{storage_failed}.
  void take(const std::string& name, std::int64_t now_ms);
  /// Removes what came before this time; returns how many.
  int sweep(std::int64_t epoch_ms);
  /// Removes what came first and can be removed. False when there is nothing.
  bool give_up_first();
  /// Of all that is here.
  [[nodiscard]] std::int64_t bytes() const { return bytes_; }

 private:
  struct Entry {
    std::string name;
    std::int64_t since_ms = 0;
  };
  [[nodiscard]] std::vector<Entry> entries() const;
  [[nodiscard]] std::string free_name(const std::string& name) const;
  void count(const std::string& name);
  void remove(const std::string& name);

  const std::filesystem::path blobs_;
  const std::filesystem::path lost_;
  DiskBudget& room_;
  std::mutex mutex_;
  std::atomic<std::int64_t> bytes_ = 0;
  std::map<std::string, std::int64_t> counted_;
};

}  // namespace unwrapd::server::blobs
