#pragma once
// Copies of the folders of a bucket in a directory of this node. A file is fetched when it is first
// read, and stays until the directory is larger than it may be: then the folders that were not used
// for longest go. The copies are those of one run of the server, which begins with none.
//
// A name that a client chose may be that of another job later. So a copy counts for one row, which
// its number tells, and goes when the name is found with another number.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/blobs/bucket_folders.hpp"

namespace unwrapd::server::blobs {

/// Thread-safe.
class CachedFolders {
 public:
  /// most_bytes: of all copies. noting: held while `digests` of a folder is written.
  CachedFolders(std::unique_ptr<BucketFolders> bucket, std::filesystem::path folder,
                std::int64_t most_bytes, std::mutex& noting);

  BucketFolders& bucket() { return *bucket_; }
  /// The copy of a folder that this node has just brought, and whose row is about to be written.
  void keep(std::string_view job, const std::string& root);
  /// The row of this number has this name now. succeeded: the attempt that made its results; 0:
  /// none yet.
  void note_row(std::string_view job, std::int64_t seq, int succeeded);
  /// The root of a folder as this node has known it; empty where it has not.
  [[nodiscard]] std::string known_root(std::string_view job) const;
  /// The same, asking where it is not known.
  [[nodiscard]] std::string root(std::string_view job);
  /// Removes the copy of a folder.
  void forget(std::string_view job) noexcept;
  void forget_file(std::string_view job, std::string_view file) noexcept;
  /// Sees to it that a file is in the copy, if it is in the folder, and that its digest is noted
  /// there. Throws StoreAway.
  void bring(std::string_view job, std::string_view file);
  /// The same of all results.
  void bring_results(std::string_view job);
  /// A result of the job with the row of this number, as it is in the bucket, which is asked once.
  /// Nothing where there is none of this name, or another job has the folder's name by now.
  std::optional<StoredObject> find_result(std::string_view job, std::int64_t seq,
                                          std::string_view file);
  /// BucketFolders::set_aside() and sweep(); copies of folders that are no longer kept go, too.
  bool set_aside(std::string_view job);
  int sweep(const Fates& fates);
  /// Removes what is too much, and forgets names that were not used lately.
  void trim();
  /// Removes the copy that was not used for longest. False where there is none.
  bool give_up_one() noexcept;

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Row {
    std::int64_t seq = 0;
    int succeeded = 0;
    std::string root = {};
    StoredObjects results = {};  ///< once they are known
    Time used = {};
  };
  struct Copy;
  [[nodiscard]] std::vector<Copy> by_use();
  [[nodiscard]] bool knows(std::string_view job, std::string_view file) const;
  BucketFolder find(std::string_view job);
  BucketFolder note_files(std::string_view job);
  bool publish(std::string_view job, const std::string& root);
  void fetch(std::string_view job, const std::string& file, const StoredObject& object);

  std::unique_ptr<BucketFolders> bucket_;
  const std::filesystem::path folder_;
  const std::int64_t most_bytes_;
  std::mutex& noting_;
  mutable std::mutex mutex_;
  std::map<std::string, Row, std::less<>> rows_;  ///< by name
};

}  // namespace unwrapd::server::blobs
