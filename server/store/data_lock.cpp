#include "server/store/data_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <system_error>

#include "core/base/error.hpp"

namespace unwrapd::server::store {
namespace {

constexpr mode_t kFileMode = 0640;

[[noreturn]] void cannot_open(const std::filesystem::path& path, const std::error_code& reason) {
  throw Error(ErrorCode::storage_failed,
              path.string() + " cannot be opened (" + reason.message() +
                  "); the server's user must be able to write in the data directory.");
}

int open_lock(const std::filesystem::path& data) {
  std::error_code failed;
  std::filesystem::create_directories(data, failed);
  if (failed) cannot_open(data, failed);
  const std::filesystem::path path = data / "lock";
  const int lock = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kFileMode);
  if (lock < 0) cannot_open(path, {errno, std::generic_category()});
  return lock;
}

}  // namespace

DataLock::DataLock(const std::filesystem::path& data) : file_(open_lock(data)) {
  if (::flock(file_.descriptor(), LOCK_EX | LOCK_NB) == 0) return;
  throw Error(ErrorCode::storage_failed,
              "The data directory " + data.string() +
                  " cannot be locked; stop any other unwrapd that uses it.");
}

}  // namespace unwrapd::server::store
