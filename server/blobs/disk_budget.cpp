#include "server/blobs/disk_budget.hpp"

#include <fcntl.h>

#include <algorithm>
#include <limits>
#include <system_error>

#include "core/base/error.hpp"
#include "server/base/files.hpp"

namespace unwrapd::server::blobs {
namespace {

constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

[[noreturn]] void full() { throw Error(ErrorCode::storage_full, std::string(kStorageFull)); }

}  // namespace

std::int64_t DiskBudget::upload_limit() const {
  return limits_.max_bytes > 0 ? limits_.max_bytes / 4 * 3 : kNoLimit;
}

bool DiskBudget::try_take(std::string_view job, std::int64_t bytes, std::int64_t limit) {
  const std::lock_guard lock(mutex_);
  if (used_ + bytes > limit) return false;
  used_ += bytes;
  by_job_[std::string(job)] += bytes;
  return true;
}

void DiskBudget::take_below(std::string_view job, std::int64_t bytes, std::int64_t limit) {
  while (!try_take(job, bytes, limit)) {
    if (!evictions_.evict || !evictions_.evict()) full();
  }
}

bool DiskBudget::is_free(std::int64_t bytes, std::int64_t left_free) const {
  std::error_code ignored;
  const auto free = std::filesystem::space(folder_, ignored).available;
  const bool known = free != static_cast<std::uintmax_t>(-1);
  return !known || static_cast<std::int64_t>(free) - bytes >= left_free;
}

/// Gives up what is in DIR/lost until so much is free. Throws if that is not enough.
void DiskBudget::free_on_disk(std::int64_t bytes, std::int64_t left_free) {
  while (!is_free(bytes, left_free)) {
    if (!evictions_.give_up_lost || !evictions_.give_up_lost()) full();
  }
}

void DiskBudget::check_free(std::int64_t bytes) const {
  if (!is_free(bytes, limits_.min_free_bytes)) full();
}

void DiskBudget::check_upload(std::int64_t bytes) const {
  if (bytes > upload_limit()) full();
}

/// Throws if there is no room even after all removable files are removed.
void DiskBudget::check_evictions(std::string_view job, std::int64_t whole) const {
  const std::int64_t evictable = evictions_.bytes ? evictions_.bytes() : 0;
  const std::lock_guard lock(mutex_);
  const auto found = by_job_.find(job);
  const std::int64_t own = found == by_job_.end() ? 0 : found->second;
  if (used_ - own - evictable > upload_limit() - whole) full();
}

bool DiskBudget::try_take_for_upload(std::string_view job, std::int64_t bytes) {
  free_on_disk(bytes, limits_.min_free_bytes);
  return try_take(job, bytes, upload_limit());
}

void DiskBudget::take_for_upload(std::string_view job, std::int64_t bytes, std::int64_t whole) {
  if (try_take_for_upload(job, bytes)) return;
  check_upload(whole);
  check_evictions(job, whole);
  take_below(job, bytes, upload_limit());
}

void DiskBudget::take(std::string_view job, std::int64_t bytes) {
  free_on_disk(bytes, limits_.min_free_bytes / 2);
  take_below(job, bytes, limits_.max_bytes > 0 ? limits_.max_bytes : kNoLimit);
}

bool DiskBudget::try_take(std::string_view job, std::int64_t bytes) {
  return is_free(bytes, limits_.min_free_bytes) && try_take(job, bytes, upload_limit());
}

void DiskBudget::put_back(std::string_view job, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  const auto found = by_job_.find(job);
  if (found == by_job_.end()) return;  // given back whole meanwhile
  const std::int64_t back = std::min(bytes, found->second);
  used_ -= back;
  if ((found->second -= back) == 0) by_job_.erase(found);
}

void DiskBudget::set(std::string_view job, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  std::int64_t& counted = by_job_[std::string(job)];
  used_ += bytes - counted;
  counted = bytes;
}

void DiskBudget::give_back(std::string_view job) {
  const std::lock_guard lock(mutex_);
  const auto found = by_job_.find(job);
  if (found == by_job_.end()) return;
  used_ -= found->second;
  by_job_.erase(found);
}

void DiskBudget::recount(std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  by_job_.clear();
  used_ = bytes;
}

void DiskBudget::free_by(const std::function<void()>& write) {
  try {
    write();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::storage_full || !reserve_.give_up()) throw;
    write();
  }
}

std::int64_t DiskBudget::used_bytes() const {
  const std::lock_guard lock(mutex_);
  return used_;
}

void DiskReserve::make() noexcept {
  const std::lock_guard lock(mutex_);
  std::error_code failed;
  const std::uintmax_t free = std::filesystem::space(file_.parent_path(), failed).available;
  if (failed || free < 2 * kReserveBytes || std::filesystem::exists(file_, failed)) return;
  try {
    const File file = File::create(file_);
    if (::posix_fallocate(file.descriptor(), 0, kReserveBytes) != 0) remove_tree(file_);
  } catch (const Error&) {  // there is none, as before
  }
}

bool DiskReserve::give_up() noexcept {
  const std::lock_guard lock(mutex_);
  std::error_code ignored;
  return std::filesystem::remove(file_, ignored);
}

}  // namespace unwrapd::server::blobs
