#include "server/sweeper.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace unwrapd::server {
namespace {

constexpr std::chrono::seconds kLongestPause{60};
constexpr int kSweepsInTime = 8;           // while a result is kept, at least
constexpr std::int64_t kSetByMs = 10'000;  // less is the clock's own drift

}  // namespace

void sweep(JobStore& store, BlobStore& blobs, std::int64_t now_ms, std::chrono::seconds keep) {
  const std::int64_t keep_ms = std::chrono::milliseconds(keep).count();
  for (const std::string& job : store.finished_before(now_ms - keep_ms)) {
    store.set_expired(job);
    blobs.remove(job);
  }
  store.forget_before(now_ms - 2 * keep_ms);
}

bool evict_oldest(JobStore& store, BlobStore& blobs) {
  const auto any_time = std::numeric_limits<std::int64_t>::max();
  for (const std::string& job : store.finished_before(any_time, 1)) {
    store.set_expired(job);
    blobs.remove(job);
    return true;
  }
  return false;
}

std::chrono::milliseconds Sweeper::pause() const {
  return std::min<std::chrono::milliseconds>(std::chrono::milliseconds(keep_) / kSweepsInTime,
                                             kLongestPause);
}

void Sweeper::sweep_once(std::int64_t now_ms, std::int64_t elapsed_ms) {
  const std::int64_t offset_ms = now_ms - elapsed_ms;
  const std::int64_t set_by_ms = offset_ms - offset_ms_.value_or(offset_ms);
  if (std::abs(set_by_ms) >= kSetByMs) {
    log_.warning("the time of day was set", {{"by_ms", set_by_ms}});
    store_.shift_kept_since(set_by_ms);
  }
  offset_ms_ = offset_ms;
  sweep(store_, blobs_, now_ms, keep_);
}

}  // namespace unwrapd::server
