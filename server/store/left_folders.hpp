#pragma once
// Folders that are to go and could not: one that cannot be opened, because no descriptor is left,
// cannot be looked into. They are remembered and tried again.

#include <filesystem>
#include <mutex>
#include <set>

namespace unwrapd::server::store {

/// Thread-safe.
class LeftFolders {
 public:
  void remove(const std::filesystem::path& folder) noexcept;
  /// Tries again what is left; returns how much that was.
  int retry() noexcept;

 private:
  std::mutex mutex_;
  std::set<std::filesystem::path> folders_;
};

}  // namespace unwrapd::server::store
