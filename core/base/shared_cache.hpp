#pragma once
// What jobs share. Core keeps nothing from one job to the next: before it makes what is costly and
// depends on a mesh alone, it asks a SharedCache that it is handed, as it is handed an Executor.

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>

#include "core/base/digest.hpp"

namespace unwrapd {

class SharedCache {
 public:
  struct Made {
    std::shared_ptr<const void> value;
    std::size_t bytes;  ///< that keeping it takes
  };

  SharedCache() = default;
  SharedCache(const SharedCache&) = delete;
  SharedCache& operator=(const SharedCache&) = delete;
  virtual ~SharedCache() = default;

  /// Another one for other bytes. Keys are written by Fingerprint (cache_key.hpp).
  [[nodiscard]] virtual Digest digest(std::span<const std::byte> bytes) const = 0;

  /// What was made under this key before, or what make() gives. Jobs that ask for the same key at
  /// once get the same value, made once; where make() throws, so does this, and the next one makes
  /// it anew. Thread-safe. make() must not ask for the same key. Throws Error{cancelled} where a
  /// stop is requested while another job makes it.
  virtual std::shared_ptr<const void> obtain(const Digest& key, const std::function<Made()>& make,
                                             const std::stop_token& stop) = 0;

  /// Bytes that one job may take.
  [[nodiscard]] virtual std::size_t memory_limit() const = 0;
};

/// That a job takes for a face beside the factor: positions, rest triangles, maps, what was read
/// and what is written (measured: 600 to 800 at 100k to 1M faces).
inline constexpr std::size_t kJobBytesPerFace = 800;

/// Throws Error{too_much_memory}, with the estimate, when a job would take so many bytes and may
/// take less.
void check_memory(std::size_t bytes, std::size_t limit);

}  // namespace unwrapd
