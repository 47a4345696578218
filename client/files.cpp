#include "client/files.hpp"

#include <unistd.h>

#include <cstdio>
#include <iterator>

#include "client/failure.hpp"

namespace unwrapd::client {
namespace fs = std::filesystem;

std::uintmax_t file_bytes(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error))
    throw Failure(ExitCode::file, "There is no file " + path.string() + "; check its name.");
  if (!fs::is_regular_file(path, error))
    throw Failure(ExitCode::file, path.string() + " is not a file; name a mesh file.");
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) throw Failure(ExitCode::file, path.string() + " cannot be read: " + error.message());
  return bytes;
}

std::string read_file(const fs::path& path) {
  file_bytes(path);
  std::ifstream stream(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream)
    throw Failure(ExitCode::file, path.string() + " cannot be read; check its permissions.");
  return bytes;
}

namespace {

bool is_below(const fs::path& path, const char* folder) {
  return path.string().starts_with(folder);
}

/// The file that path leads to, through symbolic links.
fs::path target_of(fs::path path) {
  constexpr int kMostLinks = 40;  // Linux follows no more
  std::error_code ignored;
  for (int links = 0; links < kMostLinks && fs::is_symlink(path, ignored); ++links)
    path = path.parent_path() / fs::read_symlink(path, ignored);
  return path;
}

}  // namespace

bool is_address(const fs::path& path) {
  const std::string& text = path.native();
  return text.starts_with("https://") || text.starts_with("http://");
}

fs::path local_name(const fs::path& path) {
  if (!is_address(path)) return path;
  const std::string& text = path.native();
  return fs::path(text.substr(0, text.find_first_of("?#"))).filename();
}

bool is_stream(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (is_standard(path)) return true;
  if (!fs::exists(status) || fs::is_directory(status)) return false;
  return !fs::is_regular_file(status) ||
         (fs::is_symlink(path, ignored) && (is_below(path, "/dev/") || is_below(path, "/proc/")));
}

fs::path file_behind(const fs::path& path) {
  std::error_code error;
  const fs::path target = target_of(path);
  const fs::path whole = fs::weakly_canonical(fs::absolute(target, error), error);
  return error ? target : whole;
}

NewFile::NewFile(fs::path path) : path_(std::move(path)) {
  std::error_code ignored;
  if (fs::is_directory(path_, ignored)) fail();
  if (is_stream(path_)) return;
  target_ = target_of(path_);
  temporary_ = target_;
  temporary_ += ".part" + std::to_string(getpid());
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) fail();
}

NewFile::~NewFile() {
  std::error_code ignored;  // after commit() there is nothing left to remove
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void NewFile::append(std::string_view bytes) {
  if (is_standard(path_)) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size()) fail();
    return;
  }
  if (!stream_.is_open()) stream_.open(path_, std::ios::binary | std::ios::app);
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream_) fail();
}

void NewFile::commit() {
  if (is_standard(path_)) {
    if (std::fflush(stdout) != 0) fail();
    return;
  }
  stream_.close();
  if (!stream_) fail();
  if (temporary_.empty()) return;
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) fail();
}

void NewFile::fail() const {
  if (is_standard(path_)) throw Failure(ExitCode::file, "Standard output cannot be written.");
  throw Failure(
      ExitCode::file,
      path_.string() + " cannot be written; check its folder, permissions and free space.");
}

void write_file(const fs::path& path, std::string_view bytes) {
  NewFile file(path);
  file.append(bytes);
  file.commit();
}

}  // namespace unwrapd::client
