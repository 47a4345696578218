#pragma once
// Files that several jobs and meshes have by hard links: the document of a stored mesh, results
// that answer the same question again. Their bytes are on the disk once, and count once: for the
// first of those that hold them, a mesh before all jobs, and when that goes for the next. Who holds
// a file is told by a walk through the folders at the start; the file system's count of links says
// only where to look, for a backup may have links, too.

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace unwrapd::server::store {

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

/// What a folder has on the disk.
struct FolderBytes {
  std::int64_t alone = 0;  ///< of files without a second name
  std::map<SharedFiles::Inode, std::int64_t> several;
};

/// Of all files but `digests`, which are ours, not the owner's.
FolderBytes bytes_in(const std::filesystem::path& folder);

}  // namespace unwrapd::server::store
