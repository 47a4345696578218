#pragma once
// A directory of a test's own, gone when the test is over.

#include <stdlib.h>

#include <filesystem>
#include <string>

namespace unwrapd::server {

class TempDir {
 public:
  TempDir() {
    std::string name = std::filesystem::temp_directory_path() / "unwrapd_test_XXXXXX";
    path_ = ::mkdtemp(name.data());
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  ~TempDir() { std::filesystem::remove_all(path_); }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace unwrapd::server
