#include "server/blobs/shared_files.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <system_error>

#include "server/base/identity.hpp"
#include "server/blobs/digests.hpp"

namespace unwrapd::server::blobs {

void SharedFiles::leave(const std::string& holder, Inode file, std::set<std::string>& changed) {
  const auto found = holders_.find(file);
  if (found == holders_.end()) return;
  std::vector<std::string>& holders = found->second;
  const bool was_first = !holders.empty() && holders.front() == holder;
  std::erase(holders, holder);
  if (holders.empty()) {
    holders_.erase(found);
  } else if (was_first) {
    changed.insert(holders.front());
  }
}

std::vector<std::string> SharedFiles::set(const std::string& holder, const std::set<Inode>& files) {
  std::set<std::string> changed;
  for (const Inode file : files_[holder])
    if (!files.contains(file)) leave(holder, file, changed);
  for (const Inode file : files) {
    std::vector<std::string>& holders = holders_[file];
    if (std::ranges::find(holders, holder) != holders.end()) continue;
    const bool goes_first = is_mesh_id(holder);
    if (goes_first && !holders.empty()) changed.insert(holders.front());
    holders.insert(goes_first ? holders.begin() : holders.end(), holder);
  }
  if (files.empty()) {
    files_.erase(holder);
  } else {
    files_[holder] = files;
  }
  return {changed.begin(), changed.end()};
}

bool SharedFiles::counts_for(const std::string& holder, Inode file) const {
  const auto found = holders_.find(file);
  return found == holders_.end() || found->second.front() == holder;
}

bool SharedFiles::has_others(const std::string& holder, Inode file) const {
  const auto found = holders_.find(file);
  return found != holders_.end() &&
         std::ranges::any_of(found->second, [&](const auto& other) { return other != holder; });
}

FolderBytes bytes_in(const std::filesystem::path& folder) {
  FolderBytes bytes;
  std::error_code gone;  // a file that is removed meanwhile counts nothing
  for (const std::filesystem::directory_entry& entry :
       std::filesystem::directory_iterator(folder, gone)) {
    struct stat file {};
    const bool counts = entry.path().filename() != kDigestsFile &&
                        ::lstat(entry.path().c_str(), &file) == 0 && S_ISREG(file.st_mode);
    if (!counts) continue;
    if (file.st_nlink > 1) {
      bytes.several[file.st_ino] = file.st_size;
    } else {
      bytes.alone += file.st_size;
    }
  }
  return bytes;
}

}  // namespace unwrapd::server::blobs
