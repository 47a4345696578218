#pragma once
// The folders of jobs and meshes that a store knows, copied or checked file by file against the
// digests that were noted, while others may still change them.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "server/blobs/digests.hpp"
#include "server/database/database.hpp"

namespace unwrapd::server::backup {

/// A folder of blobs/ that a row tells of.
struct KnownFolder {
  std::string name;
  bool inputs_only = false;  ///< of a job that has not ended: its results are not noted yet
};

/// In the order of their names, meshes last.
std::vector<KnownFolder> known_folders(const database::Database& store);
/// Whether it still is one.
bool is_known(const database::Database& store, const std::string& name);

/// What a pass over folders has seen.
struct FolderCounts {
  std::int64_t folders = 0;
  std::int64_t files = 0;
  std::int64_t bytes = 0;
};

/// Not for use by two threads at once.
class FolderCopy {
 public:
  /// to: nothing is written when it is empty, and the files are only checked.
  explicit FolderCopy(std::filesystem::path from, std::filesystem::path to = {})
      : from_(std::move(from)), to_(std::move(to)) {}

  /// Returns what is damaged, "j_12/document is missing": all else of the folder is copied. Looks
  /// again where a file may have been replaced meanwhile.
  std::vector<std::string> take(const KnownFolder& folder);
  [[nodiscard]] const FolderCounts& counts() const { return counts_; }

 private:
  struct Copied {
    std::string digest;
    std::filesystem::path path;
  };
  [[nodiscard]] std::string take_file(const std::string& folder, const std::string& file,
                                      const std::string& digest);
  [[nodiscard]] std::string copy_bytes(const std::filesystem::path& from,
                                       const std::filesystem::path& to);
  std::vector<std::string> take_once(const KnownFolder& folder, FolderCounts& counts);

  const std::filesystem::path from_;
  const std::filesystem::path to_;
  FolderCounts counts_;
  std::map<std::uint64_t, Copied> several_;  // files that have several names, by inode
};

/// Copies a file of the data directory whole, readable by its owner alone. Returns its SHA-256.
std::string copy_private(const std::filesystem::path& from, const std::filesystem::path& to);

/// On return everything that was written below survives a loss of power.
void sync_all(const std::filesystem::path& folder);

}  // namespace unwrapd::server::backup
