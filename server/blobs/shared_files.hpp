#pragma once
// Files that several jobs and meshes share by hard links: the document of a stored mesh, and
// results that answer the same request again. Their bytes are on the disk once and count once: for
// the first of their holders (a mesh before all jobs), and when it is removed, for the next. A walk
// through the folders at the start finds the holders. The file system's count of links only tells
// where to look, as a backup may have links, too.

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace unwrapd::server::blobs {

/// Not for use by two threads at once.
class SharedFiles {
 public:
  using Inode = std::uint64_t;

  /// The holder's files that may have several holders are these now. Returns the others of
  /// whose files one counts for them now, or no longer.
  std::vector<std::string> set(const std::string& holder, const std::set<Inode>& files);
  [[nodiscard]] bool counts_for(const std::string& holder, Inode file) const;
  [[nodiscard]] bool has_others(const std::string& holder, Inode file) const;

 private:
  void leave(const std::string& holder, Inode file, std::set<std::string>& changed);

  std::map<Inode, std::vector<std::string>> holders_;
  std::map<std::string, std::set<Inode>> files_;
};

/// The bytes of a folder on the disk.
struct FolderBytes {
  std::int64_t alone = 0;  ///< of files without a second name
  std::map<SharedFiles::Inode, std::int64_t> several;
};

/// Counts all files but `digests`, which the server needs rather than the owner.
FolderBytes bytes_in(const std::filesystem::path& folder);

}  // namespace unwrapd::server::blobs
