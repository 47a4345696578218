#pragma once
// Where an upload goes, and how its bytes are counted.

#include <cstdint>
#include <filesystem>
#include <functional>

namespace unwrapd::server::store {

/// Counts the bytes of an upload.
struct UploadMeter {
  /// Called before bytes are written. Throws Error: quota_exceeded, storage_full.
  std::function<void(std::int64_t bytes)> take = [](std::int64_t) {};
  /// Called for bytes that were written and removed again. Does not throw.
  std::function<void(std::int64_t bytes)> put_back = [](std::int64_t) {};
};

/// Where an upload goes.
struct UploadFolder {
  std::filesystem::path path;
  UploadMeter room = {};
};

}  // namespace unwrapd::server::store
