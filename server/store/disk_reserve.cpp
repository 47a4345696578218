#include "server/store/disk_reserve.hpp"

#include <fcntl.h>

#include <system_error>

#include "core/base/error.hpp"
#include "server/base/files.hpp"

namespace unwrapd::server::store {

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

}  // namespace unwrapd::server::store
