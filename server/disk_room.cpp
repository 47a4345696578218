#include "server/disk_room.hpp"

#include <limits>
#include <system_error>

#include "core/error.hpp"
#include "server/files.hpp"

namespace unwrapd::server {

bool DiskRoom::try_take(std::string_view job, std::int64_t bytes, std::int64_t limit) {
  const std::lock_guard lock(mutex_);
  if (used_ + bytes > limit) return false;
  used_ += bytes;
  by_job_[std::string(job)] += bytes;
  return true;
}

void DiskRoom::take_below(std::string_view job, std::int64_t bytes, std::int64_t limit) {
  while (!try_take(job, bytes, limit)) {
    if (!evict_ || !evict_()) throw Error(ErrorCode::storage_full, std::string(kStorageFull));
  }
}

void DiskRoom::take_for_upload(std::string_view job, std::int64_t bytes) {
  std::error_code ignored;
  const auto free = std::filesystem::space(folder_, ignored).available;
  const bool known = free != static_cast<std::uintmax_t>(-1);
  if (known && static_cast<std::int64_t>(free) - bytes < limits_.min_free_bytes)
    throw Error(ErrorCode::storage_full, std::string(kStorageFull));
  const std::int64_t most = std::numeric_limits<std::int64_t>::max();
  take_below(job, bytes, limits_.max_bytes > 0 ? limits_.max_bytes / 4 * 3 : most);
}

void DiskRoom::take(std::string_view job, std::int64_t bytes) {
  const std::int64_t most = std::numeric_limits<std::int64_t>::max();
  take_below(job, bytes, limits_.max_bytes > 0 ? limits_.max_bytes : most);
}

void DiskRoom::set(std::string_view job, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  std::int64_t& counted = by_job_[std::string(job)];
  used_ += bytes - counted;
  counted = bytes;
}

void DiskRoom::give_back(std::string_view job) {
  const std::lock_guard lock(mutex_);
  const auto found = by_job_.find(job);
  if (found == by_job_.end()) return;
  used_ -= found->second;
  by_job_.erase(found);
}

std::int64_t DiskRoom::used_bytes() const {
  const std::lock_guard lock(mutex_);
  return used_;
}

}  // namespace unwrapd::server
