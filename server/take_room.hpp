#pragma once

#include <cstdint>
#include <functional>

namespace unwrapd::server {

/// Where an upload counts what it writes.
struct TakeRoom {
  /// Told of bytes before they are written; throws Error: quota_exceeded, storage_full.
  std::function<void(std::int64_t bytes)> take = [](std::int64_t) {};
  /// Told of bytes that were written, and are gone again; does not throw.
  std::function<void(std::int64_t bytes)> put_back = [](std::int64_t) {};
};

}  // namespace unwrapd::server
