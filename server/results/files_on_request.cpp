#include "server/results/files_on_request.hpp"

#include <filesystem>

#include "core/base/error.hpp"
#include "server/base/identity.hpp"

namespace unwrapd::server::results {
namespace {

StoredResult lend(const blobs::BlobStore& blobs, std::string_view bytes) {
  return {.file = blobs.lend(bytes), .sha256 = sha256(bytes)};
}

/// Keeps a file where that takes nothing from others and no other job has taken the id meanwhile.
StoredResult keep(blobs::BlobStore& blobs, const store::JobRecord& job, const std::string& file,
                  std::string_view bytes) {
  if (!blobs.try_keep(job.id, file, bytes, job.seq)) return lend(blobs, bytes);
  return {.file = blobs.open(job.id, file), .sha256 = blobs.digest(job.id, file)};
}

}  // namespace

std::optional<StoredResult> find_whole(const blobs::BlobStore& blobs, const std::string& job,
                                       const std::string& file) {
  if (!std::filesystem::exists(blobs.path(job, file))) return std::nullopt;
  try {
    return StoredResult{.file = blobs.open(job, file), .sha256 = blobs.digest(job, file)};
  } catch (const Error& error) {
    if (error.code() == ErrorCode::storage_corrupt) return std::nullopt;  // it is made again
    throw;
  }
}

StoredResult FilesOnRequest::open(const store::JobRecord& job, const WantedFile& wanted,
                                  const std::function<std::string()>& make) {
  std::optional<StoredResult> kept;
  if (wanted.is_kept) kept = find_whole(blobs_, job.id, wanted.file);
  std::shared_ptr<void> place;
  if (!kept) {
    place = renderer_.enter(job, wanted);
    kept = find_whole(blobs_, job.id, wanted.file);  // made meanwhile
  }
  if (kept) {
    ++counts_.hits;
    return std::move(*kept);
  }
  const std::string bytes = make();
  counts_.made(bytes);
  return wanted.is_kept ? keep(blobs_, job, wanted.file, bytes) : lend(blobs_, bytes);
}

}  // namespace unwrapd::server::results
