#include "server/blobs/lost_folders.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <system_error>
#include <tuple>

#include "server/base/clock.hpp"
#include "server/base/files.hpp"

namespace unwrapd::server::blobs {
namespace {

namespace fs = std::filesystem;

/// Of itself, where it is a symbolic link.
std::int64_t time_of(const fs::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return 0;
  return status.st_mtim.tv_sec * kMsPerSecond + status.st_mtim.tv_nsec / kNsPerMs;
}

void set_time(const fs::path& path, std::int64_t epoch_ms) {
  const timespec time{.tv_sec = epoch_ms / kMsPerSecond,
                      .tv_nsec = epoch_ms % kMsPerSecond * kNsPerMs};
  const timespec both[] = {time, time};
  ::utimensat(AT_FDCWD, path.c_str(), both, AT_SYMLINK_NOFOLLOW);
}

std::int64_t bytes_lost(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(fs::symlink_status(path, ignored))) return 0;
  std::int64_t bytes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, ignored)) {
    const std::uintmax_t size = entry.file_size(ignored);
    if (!ignored) bytes += static_cast<std::int64_t>(size);
  }
  return bytes;
}

}  // namespace

std::vector<LostFolders::Entry> LostFolders::entries() const {
  std::vector<Entry> found;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(lost_, none))
    found.push_back({.name = entry.path().filename(), .since_ms = time_of(entry.path())});
  std::ranges::sort(found, [](const Entry& a, const Entry& b) {
    return std::tie(a.since_ms, a.name) < std::tie(b.since_ms, b.name);
  });
  return found;
}

void LostFolders::count(const std::string& name) {
  const std::int64_t bytes = bytes_lost(lost_ / name);
  room_.set("lost/" + name, bytes);
  bytes_ += bytes - counted_[name];
  counted_[name] = bytes;
}

void LostFolders::remove(const std::string& name) {
  remove_tree(lost_ / name);
  room_.give_back("lost/" + name);
  bytes_ -= counted_[name];
  counted_.erase(name);
}

int LostFolders::return_wanted(const std::function<bool(const std::string& name)>& wanted) {
  const std::lock_guard lock(mutex_);
  int returned = 0;
  for (const Entry& entry : entries()) {
    if (wanted(entry.name) && !fs::exists(fs::symlink_status(blobs_ / entry.name))) {
      rename_unsynced(lost_ / entry.name, blobs_ / entry.name);
      ++returned;
    } else {
      count(entry.name);
    }
  }
  if (returned > 0) sync_directory(blobs_);
  return returned;
}

/// What is lost under the same name twice is two folders: "j_1", "j_1~2".
std::string LostFolders::free_name(const std::string& name) const {
  std::string free = name;
  for (int k = 2; fs::exists(fs::symlink_status(lost_ / free)); ++k)
    free = name + "~" + std::to_string(k);
  return free;
}

void LostFolders::take(const std::string& name, std::int64_t now_ms) {
  const std::lock_guard lock(mutex_);
  make_directories(lost_);
  const std::string free = free_name(name);
  rename_unsynced(blobs_ / name, lost_ / free);
  set_time(lost_ / free, now_ms);
  sync_directory(lost_);
  count(free);
}

int LostFolders::sweep(std::int64_t epoch_ms) {
  const std::lock_guard lock(mutex_);
  int removed = 0;
  for (const Entry& entry : entries()) {
    if (entry.since_ms >= epoch_ms) break;
    remove(entry.name);
    ++removed;
  }
  return removed;
}

bool LostFolders::give_up_first() {
  const std::lock_guard lock(mutex_);
  for (const Entry& entry : entries()) {
    remove(entry.name);
    if (!fs::exists(fs::symlink_status(lost_ / entry.name))) return true;
  }
  return false;
}

}  // namespace unwrapd::server::blobs
