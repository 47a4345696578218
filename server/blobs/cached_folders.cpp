#include "server/blobs/cached_folders.hpp"

#include <algorithm>
#include <exception>
#include <numeric>
#include <utility>

#include "server/base/files.hpp"
#include "server/base/identity.hpp"
#include "server/blobs/blob_files.hpp"
#include "server/blobs/digests.hpp"
#include "server/blobs/shared_files.hpp"

namespace unwrapd::server::blobs {
namespace {

namespace fs = std::filesystem;

using Clock = std::chrono::steady_clock;

constexpr std::int64_t kNoRowYet = -1;
constexpr std::chrono::minutes kRemembered{10};  // a name without a copy
constexpr int kPartNameBytes = 8;

std::int64_t bytes_of(const fs::path& folder) {
  const FolderBytes bytes = bytes_in(folder);
  std::int64_t all = bytes.alone;
  for (const auto& [file, size] : bytes.several) all += size;
  return all;
}

}  // namespace

CachedFolders::CachedFolders(std::unique_ptr<BucketFolders> bucket, fs::path folder,
                             std::int64_t most_bytes, std::mutex& noting)
    : bucket_(std::move(bucket)),
      folder_(std::move(folder)),
      most_bytes_(most_bytes),
      noting_(noting) {}

void CachedFolders::keep(std::string_view job, const std::string& root) {
  const std::lock_guard lock(mutex_);
  rows_[std::string(job)] = {.seq = kNoRowYet, .root = root, .used = Clock::now()};
}

void CachedFolders::note_row(std::string_view job, std::int64_t seq, int succeeded) {
  const std::lock_guard lock(mutex_);
  Row& row = rows_[std::string(job)];
  if (row.seq != seq && row.seq != kNoRowYet) {
    remove_tree(folder_ / job);
    row.root.clear();
    row.results.clear();
  }
  row.seq = seq;
  row.succeeded = succeeded;
  row.used = Clock::now();
}

std::string CachedFolders::known_root(std::string_view job) const {
  const std::lock_guard lock(mutex_);
  const auto row = rows_.find(job);
  return row == rows_.end() ? std::string() : row->second.root;
}

std::string CachedFolders::root(std::string_view job) {
  std::string known = known_root(job);
  return known.empty() ? note_files(job).root : known;
}

/// Results are published by whoever misses them first. False where there are none.
bool CachedFolders::publish(std::string_view job, const std::string& root) {
  int attempt = 0;
  {
    const std::lock_guard lock(mutex_);
    if (const auto row = rows_.find(job); row != rows_.end()) attempt = row->second.succeeded;
  }
  if (attempt == 0 || root.empty()) return false;
  bucket_->publish(root, attempt);
  return true;
}

void CachedFolders::forget(std::string_view job) noexcept {
  const std::lock_guard lock(mutex_);
  if (const auto row = rows_.find(job); row != rows_.end()) rows_.erase(row);
  remove_tree(folder_ / job);
}

void CachedFolders::forget_file(std::string_view job, std::string_view file) noexcept {
  remove_tree(folder_ / job / file);
}

/// Whether the copy's list says whether there is such a file: lists of files never change.
bool CachedFolders::knows(std::string_view job, std::string_view file) const {
  const Digests digests = read_digests(folder_ / job);
  return digests.contains(file) || digests.contains(is_input(file) ? kDocumentFile : kReportFile);
}

BucketFolder CachedFolders::find(std::string_view job) {
  const auto row_number = [&] {
    const auto row = rows_.find(job);
    return row == rows_.end() ? kNoRowYet : row->second.seq;
  };
  std::int64_t seq = kNoRowYet;
  {
    const std::lock_guard lock(mutex_);
    seq = row_number();
  }
  BucketFolder folder = bucket_->find(job);
  if (!folder.files.contains(kReportFile) && publish(job, folder.root)) folder = bucket_->find(job);
  const std::lock_guard lock(mutex_);
  const auto row = rows_.find(job);
  if (folder.root.empty() || row == rows_.end() || row_number() != seq) return folder;
  row->second.root = folder.root;
  if (!folder.files.contains(kReportFile)) return folder;
  row->second.results = folder.files;
  std::erase_if(row->second.results, [](const auto& object) { return is_input(object.first); });
  return folder;
}

BucketFolder CachedFolders::note_files(std::string_view job) {
  BucketFolder folder = find(job);
  if (folder.root.empty()) return folder;
  const std::lock_guard lock(noting_);
  make_directories(folder_ / job);
  Digests digests = read_digests(folder_ / job);
  for (const auto& [file, object] : folder.files) digests[file] = object.sha256;
  write_digests(folder_ / job, digests);
  return folder;
}

/// Two threads may fetch a file at a time: the second replaces it by the same bytes.
void CachedFolders::fetch(std::string_view job, const std::string& file,
                          const StoredObject& object) {
  const fs::path part = folder_ / job / (file + "." + random_hex(kPartNameBytes) + ".part");
  if (bucket_->get(object, part)) rename_unsynced(part, folder_ / job / file);
}

void CachedFolders::bring(std::string_view job, std::string_view file) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto row = rows_.find(job); row != rows_.end()) row->second.used = Clock::now();
  }
  const bool is_there = fs::exists(folder_ / job / file);
  if (knows(job, file) && (is_there || !read_digests(folder_ / job).contains(file))) return;
  const StoredObjects files = note_files(job).files;
  const auto found = files.find(file);
  if (found != files.end() && !is_there) fetch(job, found->first, found->second);
}

void CachedFolders::bring_results(std::string_view job) {
  for (const auto& [file, object] : note_files(job).files)
    if (!is_input(file) && !fs::exists(folder_ / job / file)) fetch(job, file, object);
}

std::optional<StoredObject> CachedFolders::find_result(std::string_view job, std::int64_t seq,
                                                       std::string_view file) {
  const auto known = [&]() -> std::optional<StoredObjects> {
    const std::lock_guard lock(mutex_);
    const auto row = rows_.find(job);
    if (row == rows_.end() || row->second.seq != seq) return StoredObjects();
    if (row->second.results.empty()) return std::nullopt;
    return row->second.results;
  };
  std::optional<StoredObjects> results = known();
  if (!results) {
    find(job);
    results = known().value_or(StoredObjects());
  }
  const auto found = results->find(file);
  if (found == results->end()) return std::nullopt;
  return found->second;
}

struct CachedFolders::Copy {
  Time used;
  std::string name;
};

std::vector<CachedFolders::Copy> CachedFolders::by_use() {
  std::vector<Copy> copies;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    std::string name = entry.path().filename();
    const std::lock_guard lock(mutex_);
    const auto row = rows_.find(name);
    copies.push_back({row == rows_.end() ? Time() : row->second.used, name});
  }
  std::ranges::sort(copies, {}, &Copy::used);
  return copies;
}

bool CachedFolders::set_aside(std::string_view job) {
  forget(job);
  return bucket_->set_aside(job);
}

int CachedFolders::sweep(const Fates& fates) {
  for (const Copy& copy : by_use())
    if (fates(copy.name) == FolderFate::gone) forget(copy.name);
  return bucket_->sweep(fates, [this](const std::string& job) { note_files(job); });
}

void CachedFolders::trim() {
  const std::vector<Copy> copies = by_use();
  std::vector<std::int64_t> sizes;
  for (const Copy& copy : copies) sizes.push_back(bytes_of(folder_ / copy.name));
  std::int64_t bytes = std::accumulate(sizes.begin(), sizes.end(), std::int64_t{0});
  for (std::size_t k = 0; k < copies.size() && bytes > most_bytes_; ++k) {
    forget(copies[k].name);
    bytes -= sizes[k];
  }
  const std::lock_guard lock(mutex_);
  std::erase_if(rows_, [&](const auto& row) {
    return Clock::now() - row.second.used > kRemembered && !fs::exists(folder_ / row.first);
  });
}

bool CachedFolders::give_up_one() noexcept {
  try {
    const std::vector<Copy> copies = by_use();
    if (!copies.empty()) forget(copies.front().name);
    return !copies.empty();
  } catch (const std::exception&) {  // the directory cannot be read
    return false;
  }
}

}  // namespace unwrapd::server::blobs
