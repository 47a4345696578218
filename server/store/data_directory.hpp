#pragma once
// The data directory: the lock that keeps a second server out, and the file with the rows of jobs
// and meshes.

#include <filesystem>
#include <string>

#include "server/base/files.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/database/database_address.hpp"

namespace unwrapd::server::store {

/// Held by one server a data directory. The kernel releases it even after kill -9.
class DataLock {
 public:
  /// Creates the directory when it is missing. Throws Error{storage_failed} when another process
  /// holds it.
  explicit DataLock(const std::filesystem::path& data);

 private:
  File file_;
};

inline constexpr const char* kStoreFile = "jobs.sqlite";

/// The rows of a data directory: kStoreFile, or the database with this URL where there is one.
database::DatabaseAddress address_in(const std::filesystem::path& data,
                                     const database::PostgresAddress& database);

/// The same. Throws Error{storage_failed} when that has no tables, or in PostgreSQL no job and no
/// mesh ever, although there are files of jobs: the sweep at the start would take them all away, as
/// no row names them.
database::DatabaseAddress store_in(const std::filesystem::path& data,
                                   const database::PostgresAddress& database,
                                   const blobs::BlobStore& blobs);

/// The id of the node that works in this data directory; made when it is missing.
std::string node_in(const std::filesystem::path& data);

/// Whether what the server has made in its data directory, and in that of the files, is there.
bool is_whole(const std::filesystem::path& data, const std::filesystem::path& blobs,
              const database::PostgresAddress& database);

}  // namespace unwrapd::server::store
