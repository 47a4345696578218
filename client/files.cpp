#include "client/files.hpp"

#include <unistd.h>

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
  return fs::file_size(path);
}

std::string read_file(const fs::path& path) {
  file_bytes(path);
  std::ifstream stream(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream)
    throw Failure(ExitCode::file, path.string() + " cannot be read; check its permissions.");
  return bytes;
}

NewFile::NewFile(fs::path path) : path_(std::move(path)), temporary_(path_) {
  temporary_ += ".part" + std::to_string(getpid());
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) fail();
}

NewFile::~NewFile() {
  std::error_code ignored;  // after commit() there is nothing left to remove
  fs::remove(temporary_, ignored);
}

void NewFile::append(std::string_view bytes) {
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream_) fail();
}

void NewFile::commit() {
  stream_.close();
  if (!stream_) fail();
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) fail();
}

void NewFile::fail() const {
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
