#pragma once
// The data directory: the lock that keeps a second server out, and the file with the rows of jobs
// and meshes.

#include <filesystem>

#include "server/base/files.hpp"
#include "server/store/blob_store.hpp"

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

/// The path of kStoreFile in the data directory. Throws Error{storage_failed} when that file has no
/// tables although there are files of jobs: the sweep at the start would remove them all, as no row
/// names them.
std::filesystem::path store_in(const std::filesystem::path& data, const BlobStore& blobs);

}  // namespace unwrapd::server::store
