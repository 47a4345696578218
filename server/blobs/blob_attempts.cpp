// The part of blob_store.hpp for a directory that several nodes share.
#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <string>
#include <system_error>

#include "core/base/error.hpp"
#include "server/base/clock.hpp"
#include "server/blobs/blob_store.hpp"

namespace unwrapd::server::blobs {
namespace {

namespace fs = std::filesystem;

/// Files of a job that no row names are another node's upload or result for at most so long.
constexpr std::int64_t kAtWorkMs = 3'600'000;

/// The time when a folder, or a file in it, was written last.
std::int64_t written_ms(const fs::path& path) {
  const auto ms_of = [](const fs::path& of) {
    std::error_code gone;
    const auto time = fs::last_write_time(of, gone);
    if (gone) return std::int64_t{0};
    const auto since = std::chrono::file_clock::to_sys(time).time_since_epoch();
    return std::int64_t{std::chrono::floor<std::chrono::milliseconds>(since).count()};
  };
  std::int64_t newest = ms_of(path);
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, none))
    newest = std::max(newest, ms_of(entry.path()));
  return newest;
}

}  // namespace

fs::path BlobStore::attempt_folder(std::string_view job, int attempt) const {
  return incoming_ / (std::string(job) + "." + std::to_string(attempt));
}

/// Where the results of a job at work are written.
fs::path BlobStore::work_folder(std::string_view job, int attempt) const {
  return is_shared_by_nodes() ? attempt_folder(job, attempt) : blobs_ / job;
}

/// Keeps other nodes from noting digests of a job, or of all where none is named, while the pointer
/// lives. nullptr where there are no other nodes.
std::shared_ptr<void> BlobStore::lock_folder(std::string_view job) const {
  if (!is_shared_by_nodes()) return nullptr;
  const int folder = ::open((blobs_ / job).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0)
    throw Error(ErrorCode::storage_failed, "The files of this job are gone; send the job again.");
  auto locked = std::make_shared<File>(folder);
  while (::flock(folder, LOCK_EX) != 0 && errno == EINTR) {
  }
  return locked;
}

/// The digests go last: until the folder of the attempt is removed, all this can be done again.
void BlobStore::publish(std::string_view job, int attempt) {
  const fs::path from = attempt_folder(job, attempt);
  if (copies_) return publish_in_bucket(job, attempt);
  if (is_shared_by_nodes() && fs::exists(from)) publish_here(job, from);
}

void BlobStore::publish_here(std::string_view job, const fs::path& from) {
  const std::lock_guard lock(noting_);
  const std::shared_ptr<void> locked = lock_folder(job);
  const Digests results = read_digests(from);
  if (!results.contains(kReportFile)) return;  // another node has done it, and removes the folder
  Digests digests = read_digests(blobs_ / job);
  for (const auto& [file, digest] : results) {
    std::error_code is_there;
    fs::rename(from / file, blobs_ / job / file, is_there);
    digests[file] = digest;
  }
  write_digests(blobs_ / job, digests);
  sync_directory(blobs_ / job);
  left_.remove(from);
}

void BlobStore::drop_attempt(std::string_view job, int attempt) noexcept {
  if (is_shared_by_nodes() && is_file_name(job)) left_.remove(attempt_folder(job, attempt));
}

bool BlobStore::is_idle(std::string_view job, std::chrono::seconds time) const {
  if (copies_) return std::chrono::seconds(copies_->bucket().age_s(job)) > time;
  return server::now_ms() - written_ms(blobs_ / job) > std::chrono::milliseconds(time).count();
}

/// Results of a job that has succeeded are not where they belong when its node died in between.
void BlobStore::settle_attempts(const Fates& fates) const {
  if (!is_shared_by_nodes()) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(incoming_)) {
    const std::string name = entry.path().filename();
    const std::size_t dot = name.rfind('.');
    if (dot != std::string::npos) static_cast<void>(fates(name.substr(0, dot)));
  }
}

/// Whether this may be what another node works on now.
bool BlobStore::may_be_at_work(const fs::path& path, std::int64_t now_ms) const {
  return is_shared_by_nodes() && now_ms - written_ms(path) < kAtWorkMs;
}

}  // namespace unwrapd::server::blobs
