#include "server/store/left_folders.hpp"

#include <system_error>

namespace unwrapd::server::store {

void LeftFolders::remove(const std::filesystem::path& folder) noexcept {
  std::error_code failed;
  std::filesystem::remove_all(folder, failed);
  if (!failed) return;
  const std::lock_guard lock(mutex_);
  folders_.insert(folder);
}

int LeftFolders::retry() noexcept {
  std::set<std::filesystem::path> left;
  {
    const std::lock_guard lock(mutex_);
    left.swap(folders_);
  }
  for (const std::filesystem::path& folder : left) remove(folder);
  return static_cast<int>(left.size());
}

}  // namespace unwrapd::server::store
