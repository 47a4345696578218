#include "server/blob_store.hpp"

#include "server/files.hpp"

namespace unwrapd::server {
namespace {

namespace fs = std::filesystem;

void remove_unfinished(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_unfinished(entry.path())) remove_tree(entry.path());
  }
}

}  // namespace

std::string result_file(std::string_view format) { return "result." + std::string(format); }

BlobStore::BlobStore(const fs::path& data) : incoming_(data / "incoming"), blobs_(data / "blobs") {
  make_directories(incoming_);
  make_directories(blobs_);
}

fs::path BlobStore::begin_upload(std::string_view job) {
  fs::path folder = incoming_ / job;
  make_directories(folder);
  return folder;
}

void BlobStore::keep_upload(std::string_view job) {
  sync_directory(incoming_ / job);
  rename_durably(incoming_ / job, blobs_ / job);
}

void BlobStore::drop_upload(std::string_view job) noexcept { remove_tree(incoming_ / job); }

fs::path BlobStore::path(std::string_view job, std::string_view file) const {
  return blobs_ / job / file;
}

void BlobStore::write(std::string_view job, std::string_view file, std::string_view bytes) {
  write_file(path(job, file), bytes);
}

void BlobStore::remove(std::string_view job) noexcept { remove_tree(blobs_ / job); }

void BlobStore::sweep(const std::function<bool(const std::string& job)>& is_known) {
  for (const fs::directory_entry& entry : fs::directory_iterator(incoming_))
    remove_tree(entry.path());
  for (const fs::directory_entry& entry : fs::directory_iterator(blobs_)) {
    if (is_known(entry.path().filename())) {
      remove_unfinished(entry.path());
    } else {
      remove_tree(entry.path());
    }
  }
}

}  // namespace unwrapd::server
