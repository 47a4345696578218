#pragma once
// Reads whole files, and writes files so that a reader never sees a part of one.

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace unwrapd::client {

/// Throws Failure{file}.
std::string read_file(const std::filesystem::path& path);

/// Throws Failure{file} unless path is a readable regular file.
std::uintmax_t file_bytes(const std::filesystem::path& path);

/// "-": standard input, or standard output.
inline bool is_standard(const std::filesystem::path& path) { return path == "-"; }

/// "https://host/x.glb": the address of a mesh, which the server reads.
bool is_address(const std::filesystem::path& path);

/// The name that a file of this path has here: of an address the last part of its path.
std::filesystem::path local_name(const std::filesystem::path& path);

/// Whether path is standard input or output, a pipe, a device, or a name for an open file, as
/// /dev/stdout is one: no new file may take its place, and its size is not known.
bool is_stream(const std::filesystem::path& path);

/// The file that a path leads to, through symbolic links: the same for all paths to one file.
std::filesystem::path file_behind(const std::filesystem::path& path);

/// Collects bytes under a temporary name beside path; commit() renames it. Without commit() the
/// temporary file is removed and an older file of that name stays. A symbolic link stays: the file
/// that it leads to is replaced. A stream gets the bytes as they come.
class NewFile {
 public:
  /// Throws Failure{file} if the folder is not writable, or path is a folder.
  explicit NewFile(std::filesystem::path path);
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  void append(std::string_view bytes);
  void commit();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  std::filesystem::path target_, temporary_;  ///< empty for a stream
  std::ofstream stream_;
};

/// Writes the whole file by NewFile.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace unwrapd::client
