// The part of blob_store.hpp for folders in a bucket, of which this node has copies.
#include <utility>

#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/blobs/blob_store.hpp"

namespace unwrapd::server::blobs {

namespace fs = std::filesystem;

BlobStore::BlobStore(const fs::path& copies, const DiskLimits& limits,
                     std::unique_ptr<BucketFolders> bucket, std::int64_t most_copied_bytes)
    : BlobStore(copies, limits, Sharing::by_nodes) {
  for (const fs::path& folder : {incoming_, blobs_}) {
    remove_tree(folder);
    make_directories(folder);
  }
  copies_ = std::make_unique<CachedFolders>(std::move(bucket), blobs_, most_copied_bytes, noting_);
}

void BlobStore::note_row(std::string_view job, std::int64_t seq, int succeeded) {
  if (copies_) copies_->note_row(job, seq, succeeded);
}

void BlobStore::trim_copies() {
  if (copies_) copies_->trim();
}

void BlobStore::bring(std::string_view job, std::string_view file) const {
  if (copies_) copies_->bring(job, file);
}

std::optional<ResultLink> BlobStore::link(const std::string& job, std::int64_t seq,
                                          std::string_view file, std::string_view method,
                                          std::string_view type) const {
  if (!copies_) return std::nullopt;
  const std::optional<StoredObject> object = copies_->find_result(job, seq, file);
  if (!object) return std::nullopt;
  const bucket::LinkTerms terms{.method = std::string(method),
                                .content_type = std::string(type),
                                .cache_control = "private, no-cache"};
  return ResultLink{.url = copies_->bucket().link(*object, terms), .sha256 = object->sha256};
}

void BlobStore::keep_in_bucket(std::string_view upload, std::string_view job) {
  const std::optional<std::string> root = copies_->bucket().put_input(job, incoming_ / upload);
  if (!root)
    throw Error(ErrorCode::storage_failed, "A job of this id has files; send the job again.");
  copies_->forget(job);
  copies_->keep(job, *root);
}

std::int64_t BlobStore::seal_in_bucket(std::string_view job, int attempt, const fs::path& folder) {
  copies_->bucket().put_results(copies_->root(job), attempt, folder);
  std::int64_t bytes = bytes_in(folder).alone;
  for (const auto& [file, object] : copies_->bucket().find(job).files)
    if (is_input(file)) bytes += object.bytes;
  return bytes;
}

/// This node has the results at once. Another that misses them does not wait for this one
/// (CachedFolders::bring()).
void BlobStore::publish_in_bucket(std::string_view job, int attempt) {
  const fs::path from = attempt_folder(job, attempt);
  if (!fs::exists(from)) return;
  copies_->bucket().publish_later(copies_->known_root(job), attempt);
  make_directories(blobs_ / job);
  publish_here(job, from);
}

void BlobStore::remove_in_bucket(std::string_view job) noexcept {
  copies_->bucket().remove_later(job, copies_->known_root(job));
  copies_->forget(job);
}

/// What can be made again is kept here alone. False where there is no room.
bool BlobStore::keep_copy(std::string_view job, const std::string& file, std::string_view bytes) {
  try {
    room_.check_free(static_cast<std::int64_t>(bytes.size()));
    make_directories(blobs_ / job);
    write_file(place(job, file), bytes);
    note(job, file);
    return true;
  } catch (const Error& error) {
    remove_tree(place(job, file));
    if (error.code() == ErrorCode::storage_full) return false;
    throw;
  }
}

}  // namespace unwrapd::server::blobs
