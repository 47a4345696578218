#include "server/data_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include "core/error.hpp"

namespace unwrapd::server {
namespace {

constexpr mode_t kFileMode = 0640;

int open_lock(const std::filesystem::path& data) {
  make_directories(data);
  return ::open((data / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kFileMode);
}

}  // namespace

DataLock::DataLock(const std::filesystem::path& data) : file_(open_lock(data)) {
  if (::flock(file_.descriptor(), LOCK_EX | LOCK_NB) == 0) return;
  throw Error(ErrorCode::storage_failed, "The data directory " + data.string() +
                                             " cannot be locked: is another unwrapd using it?");
}

}  // namespace unwrapd::server
