#include "server/store_file.hpp"

#include "core/error.hpp"
#include "server/schema.hpp"

namespace unwrapd::server {

std::filesystem::path store_in(const std::filesystem::path& data, const BlobStore& blobs) {
  std::filesystem::path file = data / kStoreFile;
  const int folders = blobs.folder_count();
  if (folders == 0 || has_tables(Database(file))) return file;
  throw Error(
      ErrorCode::storage_failed,
      "The file " + file.string() + " is missing or empty, and " + (data / "blobs").string() +
          " has the files of " + std::to_string(folders) +
          " jobs and meshes, which only it knows: put it back (with its -wal file, if there "
          "is one), or remove the folder blobs to begin anew.");
}

}  // namespace unwrapd::server
