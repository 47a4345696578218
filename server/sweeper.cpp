#include "server/sweeper.hpp"

#include <algorithm>
#include <exception>

#include "server/clock.hpp"

namespace unwrapd::server {
namespace {

constexpr std::chrono::seconds kLongestPause{60};

}  // namespace

void sweep(JobStore& store, BlobStore& blobs, std::int64_t now_ms, std::chrono::seconds keep) {
  const std::int64_t keep_ms = std::chrono::milliseconds(keep).count();
  for (const std::string& job : store.finished_before(now_ms - keep_ms)) {
    store.set_expired(job);
    blobs.remove(job);
  }
  store.forget_before(now_ms - 2 * keep_ms);
}

Sweeper::Sweeper(JobStore& store, BlobStore& blobs, const Log& log, std::chrono::seconds keep)
    : thread_([this, &store, &blobs, &log, keep](const std::stop_token& stop) {
        const std::chrono::seconds pause = std::min(keep, kLongestPause);
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
          try {
            sweep(store, blobs, now_ms(), keep);
          } catch (const std::exception& error) {
            log.error("sweeping failed", {{"reason", error.what()}});
          }
          wake_.wait_for(lock, stop, pause, [] { return false; });
        }
      }) {}

}  // namespace unwrapd::server
