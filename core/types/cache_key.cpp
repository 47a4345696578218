#include "core/types/cache_key.hpp"

namespace unwrapd {
namespace {

constexpr std::size_t kFewBytes = 64;  // are not worth a digest of their own

}  // namespace

Digest CacheKey::digest() const { return core_.digest(bytes_); }

void CacheKey::append(std::span<const std::byte> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void CacheKey::add_bytes(std::span<const std::byte> bytes) {
  if (bytes.size() <= kFewBytes)
    append(bytes);
  else
    append(core_.digest(bytes));
}

}  // namespace unwrapd
