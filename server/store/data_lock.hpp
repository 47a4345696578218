#pragma once
// One server a data directory: a lock that the kernel gives back even after kill -9.

#include <filesystem>

#include "server/base/files.hpp"

namespace unwrapd::server::store {

class DataLock {
 public:
  /// Creates the directory when it is missing. Throws Error{storage_failed} when another process
  /// holds it.
  explicit DataLock(const std::filesystem::path& data);

 private:
  File file_;
};

}  // namespace unwrapd::server::store
