#include "server/store/store_file.hpp"

#include <system_error>

#include "core/base/error.hpp"
#include "server/store/schema.hpp"

namespace unwrapd::server::store {

std::filesystem::path store_in(const std::filesystem::path& data, const BlobStore& blobs) {
  std::filesystem::path file = data / kStoreFile;
  const int folders = blobs.folder_count();
  if (folders == 0) return file;
  std::error_code none;  // what is opened to be written may lose a -wal file that is damaged
  const bool is_empty = std::filesystem::file_size(file, none) == 0 || none;
  if (!is_empty && has_tables(Database(file, Database::Access::read))) return file;
  throw Error(ErrorCode::storage_failed,
              "The file " + file.string() + " is missing or empty, and " +
                  (data / "blobs").string() + " has the files of " + std::to_string(folders) +
                  " jobs and meshes that only it lists; restore it (with its -wal file, if there "
                  "is one), or remove the folder blobs to start empty.");
}

}  // namespace unwrapd::server::store
