#pragma once
// Where an upload goes, and where it counts what it writes.

#include <cstdint>
#include <filesystem>
#include <functional>

namespace unwrapd::server::store {

/// Where an upload counts what it writes.
struct UploadMeter {
  /// Told of bytes before they are written; throws Error: quota_exceeded, storage_full.
  std::function<void(std::int64_t bytes)> take = [](std::int64_t) {};
  /// Told of bytes that were written, and are gone again; does not throw.
  std::function<void(std::int64_t bytes)> put_back = [](std::int64_t) {};
};

/// Where an upload goes.
struct UploadFolder {
  std::filesystem::path path;
  UploadMeter room = {};
};

}  // namespace unwrapd::server::store
