#pragma once
// Files read whole, and files written so that a reader never sees half of one.

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace unwrapd::client {

/// Throws Failure{file}.
std::string read_file(const std::filesystem::path& path);

/// Throws Failure{file} when path is not a readable regular file.
std::uintmax_t file_bytes(const std::filesystem::path& path);

/// Collects bytes under a temporary name beside path; commit() gives the file its name. Without
/// commit() nothing is left behind and an older file of that name stays as it was.
class NewFile {
 public:
  /// Throws Failure{file} when the folder cannot be written.
  explicit NewFile(std::filesystem::path path);
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  void append(std::string_view bytes);
  void commit();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::ofstream stream_;
};

/// The whole file at once, as NewFile does it.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace unwrapd::client
