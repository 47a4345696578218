#include "server/store/data_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <system_error>

#include "core/base/error.hpp"
#include "server/store/schema.hpp"
#include "server/store/sqlite_database.hpp"

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

std::filesystem::path store_in(const std::filesystem::path& data, const BlobStore& blobs) {
  std::filesystem::path file = data / kStoreFile;
  const int folders = blobs.folder_count();
  if (folders == 0) return file;
  std::error_code none;  // what is opened to be written may lose a -wal file that is damaged
  const bool is_empty = std::filesystem::file_size(file, none) == 0 || none;
  if (!is_empty && has_tables(SqliteDatabase(file, SqliteDatabase::Access::read))) return file;
  throw Error(ErrorCode::storage_failed,
              "The file " + file.string() + " is missing or empty, and " +
                  (data / "blobs").string() + " has the files of " + std::to_string(folders) +
                  " jobs and meshes that only it lists; restore it (with its -wal file, if there "
                  "is one), or remove the folder blobs to start empty.");
}

}  // namespace unwrapd::server::store
