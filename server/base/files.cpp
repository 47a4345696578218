#include "server/base/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/base/error.hpp"
#include "server/base/errors.hpp"

namespace unwrapd::server {
namespace {

constexpr mode_t kFileMode = 0640;
constexpr std::string_view kPartSuffix = ".part";
constexpr std::size_t kSyncsAtOnce = 4;
constexpr int kBusyRetrySeconds = 5;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

/// Throws with the text of errno, but without the path, since users read it.
[[noreturn]] void fail(std::string_view doing) {
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
  if (full) throw Error(ErrorCode::storage_full, std::string(kStorageFull));
  if (errno == EMFILE || errno == ENFILE) {
    throw RetryLater(ErrorCode::rate_limited,
                     "The server has too many files open; try again after Retry-After.",
                     kBusyRetrySeconds);
  }
  const std::string reason = std::generic_category().message(errno);
  throw Error(ErrorCode::storage_failed,
              "The server failed to " + std::string(doing) + " (" + reason + "); try again later.");
}

std::filesystem::path part_of(std::filesystem::path path) { return path += kPartSuffix; }

/// The file of these bytes under another name, given its own once `finish` has done with it; not
/// left behind when that fails.
template <class Finish>
void write_part(const std::filesystem::path& path, std::string_view bytes, const Finish& finish) {
  const std::filesystem::path part = part_of(path);
  remove_tree(part);
  try {
    File file = File::create(part);
    file.append(bytes);
    finish(file, part);
  } catch (...) {
    remove_tree(part);
    throw;
  }
}

}  // namespace

File::File(File&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

File::~File() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

File File::create(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kFileMode);
  if (descriptor < 0) fail("create a file");
  return File(descriptor);
}

File File::open(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // of a pipe
  if (descriptor < 0) fail("open a file");
  File file(descriptor);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) fail("read a file");
  if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
    throw Error(ErrorCode::storage_failed,
                "The server found a pipe or a device in the place of a file; its operator must "
                "remove it.");
  return file;
}

void File::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write a file");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void File::sync() {
  if (::fsync(descriptor_) != 0) fail("write a file");
}

void File::begin_sync() noexcept { ::sync_file_range(descriptor_, 0, 0, SYNC_FILE_RANGE_WRITE); }

std::int64_t File::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail("read a file");
  return status.st_size;
}

FileStamp File::stamp() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail("read a file");
  return {.device = status.st_dev,
          .inode = status.st_ino,
          .size = status.st_size,
          .changed_ns = status.st_mtim.tv_sec * kNsPerSecond + status.st_mtim.tv_nsec};
}

std::string File::read(std::int64_t offset, std::size_t length) const {
  std::string bytes(length, '\0');
  std::size_t done = 0;
  while (done < length) {
    const off_t at = offset + static_cast<off_t>(done);
    const ssize_t got = ::pread(descriptor_, bytes.data() + done, length - done, at);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("read a file");
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

std::string read_file(const std::filesystem::path& path) {
  const File file = File::open(path);
  return file.read(0, static_cast<std::size_t>(file.size()));
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  write_file_unlisted(path, bytes, [] {});
  sync_directory(path.parent_path());
}

void write_file_unlisted(const std::filesystem::path& path, std::string_view bytes,
                         const std::function<void()>& before_naming) {
  write_part(path, bytes, [&](File& file, const std::filesystem::path& part) {
    file.sync();
    before_naming();
    rename_unsynced(part, path);
  });
}

void write_file_unsynced(const std::filesystem::path& path, std::string_view bytes) {
  write_part(path, bytes, [&](File& file, const std::filesystem::path& part) {
    file.begin_sync();
    rename_unsynced(part, path);
  });
}

void sync_file(const std::filesystem::path& path) { File::open(path).sync(); }

/// Where no thread is left to be had, a share waits for finish().
Syncs::Syncs(const std::vector<std::filesystem::path>& files) {
  const std::size_t count = std::min(files.size(), kSyncsAtOnce);
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<std::filesystem::path> share;
    for (std::size_t i = k; i < files.size(); i += count) share.push_back(files[i]);
    shares_.push_back(
        std::async(std::launch::async | std::launch::deferred, [share = std::move(share)] {
          for (const std::filesystem::path& file : share) sync_file(file);
        }));
  }
}

void Syncs::finish() {
  for (std::future<void>& share : shares_) share.get();
  shares_.clear();
}

bool is_file_name(std::string_view text) {
  return !text.empty() && text != "." && text != ".." && text.find('/') == std::string_view::npos &&
         text.find('\0') == std::string_view::npos;
}

bool is_unfinished(const std::filesystem::path& path) { return path.extension() == kPartSuffix; }

void sync_directory(const std::filesystem::path& directory) {
  const File handle = File::open(directory);
  if (::fsync(handle.descriptor()) != 0) fail("write a directory");
}

void rename_unsynced(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) fail("name a file");
}

void make_directories(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!error) return;
  errno = error.value();
  fail("create a directory");
}

void remove_tree(const std::filesystem::path& path) noexcept {
  std::error_code failed;
  std::filesystem::remove(path, failed);  // a file: without a descriptor, which may not be had
  if (failed) std::filesystem::remove_all(path, failed);
}

}  // namespace unwrapd::server
