#include "server/blobs/checked_files.hpp"

#include "server/base/clock.hpp"
#include "server/blobs/digests.hpp"

namespace unwrapd::server::blobs {
namespace {

constexpr std::int64_t kSettledMs = 2000;

}  // namespace

bool CheckedFiles::is_whole(const File& file, const std::string& digest) {
  const FileStamp stamp = file.stamp();
  {
    const std::lock_guard lock(mutex_);
    const auto found = digests_.find(stamp);
    if (found != digests_.end()) return found->second == digest;
  }
  const std::int64_t began_ms = now_ms();
  if (sha256_of(file) != digest) return false;
  const bool settled = stamp.changed_ns / kNsPerMs + kSettledMs < began_ms;
  if (settled && file.stamp() == stamp) remember(stamp, digest);
  return true;
}

void CheckedFiles::remember(const FileStamp& stamp, const std::string& digest) {
  const std::lock_guard lock(mutex_);
  if (!digests_.emplace(stamp, digest).second) return;
  order_.push_back(stamp);
  if (order_.size() <= most_) return;
  digests_.erase(order_.front());
  order_.pop_front();
}

}  // namespace unwrapd::server::blobs
