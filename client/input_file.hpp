#pragma once
// FILE as it can be sent. The size of a body is sent before its bytes, so that what a pipe brings
// is copied to a temporary file first.

#include <filesystem>
#include <optional>
#include <stop_token>

namespace unwrapd::client {

/// A new empty file in the folder of temporary files, which is removed at the end.
class TemporaryFile {
 public:
  TemporaryFile();  ///< throws Failure{file}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

class InputFile {
 public:
  /// Reads standard input ("-"), a pipe or a device to its end. Throws Failure: file, or
  /// interrupted once it is stopped.
  InputFile(const std::filesystem::path& path, const std::stop_token& stop);

  /// Of a regular file.
  [[nodiscard]] const std::filesystem::path& path() const { return copy_ ? copy_->path() : path_; }

 private:
  const std::filesystem::path path_;
  std::optional<TemporaryFile> copy_;
};

}  // namespace unwrapd::client
