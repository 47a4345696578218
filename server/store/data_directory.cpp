#include "server/store/data_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <system_error>

#include "core/base/error.hpp"
#include "server/base/identity.hpp"
#include "server/database/schema.hpp"
#include "server/database/sqlite_database.hpp"

namespace unwrapd::server::store {
namespace {

constexpr mode_t kFileMode = 0640;
constexpr std::size_t kNodeBytes = 8;

[[noreturn]] void cannot_open(const std::filesystem::path& path, const std::error_code& reason) {
  throw Error(ErrorCode::storage_failed,
              path.string() + " cannot be opened (" + reason.message() +
                  "); the server's user must be able to write in the data directory.");
}

/// Opened to be read: what is opened to be written may lose a -wal file that is damaged.
bool has_tables_in(const std::filesystem::path& file) {
  std::error_code none;
  const bool is_empty = std::filesystem::file_size(file, none) == 0 || none;
  return !is_empty && database::has_tables(
                          database::SqliteDatabase(file, database::SqliteDatabase::Access::read));
}

/// Whether it lists a job or a mesh, or did so once. Tables alone say nothing: keys are there
/// before the first start.
bool has_had_rows(const database::Database& database) {
  if (!database::has_tables(database)) return false;
  return database::number_of(
             database,
             "SELECT (SELECT COUNT(*) FROM pg_sequences WHERE schemaname = current_schema()"
             " AND sequencename IN ('jobs_seq_seq', 'meshes_seq_seq')"
             " AND last_value IS NOT NULL)"
             " + (SELECT COUNT(*) FROM (SELECT 1 FROM jobs LIMIT 1) AS job)"
             " + (SELECT COUNT(*) FROM (SELECT 1 FROM meshes LIMIT 1) AS mesh)") > 0;
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

database::DatabaseAddress address_in(const std::filesystem::path& data,
                                     const database::PostgresAddress& database) {
  if (database.url.empty()) return data / kStoreFile;
  return database;
}

database::DatabaseAddress store_in(const std::filesystem::path& data,
                                   const database::PostgresAddress& database,
                                   const blobs::BlobStore& blobs) {
  database::DatabaseAddress address = address_in(data, database);
  const int folders = blobs.folder_count();
  if (folders == 0) return address;
  const bool in_file = database.url.empty();
  if (in_file ? has_tables_in(data / kStoreFile) : has_had_rows(*address.open())) return address;
  const std::string file = (data / kStoreFile).string();
  const std::string which = in_file ? "The file " + file + " is missing or empty"
                                    : "The database of --database lists no job and no mesh";
  const std::string files = ", and " + (data / "blobs").string() + " has the files of " +
                            std::to_string(folders) + " jobs and meshes";
  if (!in_file && has_tables_in(data / kStoreFile))
    throw Error(ErrorCode::storage_failed,
                which + files + ", which " + file +
                    " lists; start without --database, or give another --data directory.");
  const std::string how = in_file ? "restore it (with its -wal file, if there is one)"
                                  : "load its dump (psql or pg_restore)";
  throw Error(ErrorCode::storage_failed, which + files + " that only it lists; " + how +
                                             ", or remove the folder blobs to start empty.");
}

std::string node_in(const std::filesystem::path& data) {
  const std::filesystem::path file = data / "node";
  if (!std::filesystem::exists(file)) write_file(file, "n_" + random_hex(kNodeBytes));
  return read_file(file);
}

bool is_whole(const std::filesystem::path& data, const std::filesystem::path& blobs,
              const database::PostgresAddress& database) {
  return std::filesystem::is_directory(blobs / "blobs") &&
         (!database.url.empty() || std::filesystem::exists(data / kStoreFile));
}

}  // namespace unwrapd::server::store
