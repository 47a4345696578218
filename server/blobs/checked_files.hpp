#pragma once
// Which files have been found to have the digest that was noted of them, so that HEAD, 304 and
// ranges do not read a whole file each time. A file counts as checked while it is the same one
// (device and inode) with the same size and time of writing; one that was written within the last
// seconds is checked again, since the clock of a file system ticks in milliseconds and two writes
// may bear the same time.

#include <cstddef>
#include <deque>
#include <map>
#include <mutex>
#include <string>

#include "server/base/files.hpp"

namespace unwrapd::server::blobs {

/// Thread-safe.
class CheckedFiles {
 public:
  /// most: that are remembered; the first go first.
  explicit CheckedFiles(std::size_t most = 65'536) : most_(most) {}

  /// Whether the SHA-256 of the file's bytes is this; they are read unless that is known.
  [[nodiscard]] bool is_whole(const File& file, const std::string& digest);

 private:
  void remember(const FileStamp& stamp, const std::string& digest);

  const std::size_t most_;
  std::mutex mutex_;
  std::map<FileStamp, std::string> digests_;
  std::deque<FileStamp> order_;  // of digests_, the first at the front
};

}  // namespace unwrapd::server::blobs
