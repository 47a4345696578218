#include "server/sweeper.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace unwrapd::server {
namespace {

constexpr std::chrono::seconds kLongestPause{60};
constexpr int kSweepsInTime = 8;           // while a result is kept, at least
constexpr std::int64_t kSetByMs = 10'000;  // less is the clock's own drift
constexpr auto kAnyTime = std::numeric_limits<std::int64_t>::max();

/// The row first: what has none is swept, should the rest of it not come about.
void remove(const MeshRecord& mesh, MeshStore& meshes, BlobStore& blobs) {
  meshes.remove(mesh.id);
  blobs.remove(mesh.id);
}

}  // namespace

void sweep(JobStore& store, BlobStore& blobs, std::int64_t now_ms, std::chrono::seconds keep) {
  const std::int64_t keep_ms = std::chrono::milliseconds(keep).count();
  for (const std::string& job : store.finished_before(now_ms - keep_ms)) {
    store.set_expired(job);
    blobs.remove(job);
  }
  store.forget_before(now_ms - 2 * keep_ms);
}

void sweep(MeshStore& meshes, BlobStore& blobs, std::int64_t now_ms, std::chrono::seconds keep) {
  const std::int64_t keep_ms = std::chrono::milliseconds(keep).count();
  for (const MeshRecord& mesh : meshes.unused_since(now_ms - keep_ms)) {
    if (!blobs.is_shared(mesh.id)) remove(mesh, meshes, blobs);
  }
}

bool evict_oldest(JobStore& store, MeshStore& meshes, BlobStore& blobs) {
  const std::vector<std::string> finished = store.finished_before(kAnyTime, 1);
  std::optional<JobRecord> job;
  if (!finished.empty()) job = store.find(finished.front());
  for (const MeshRecord& mesh : meshes.unused_since(job ? job->finished_ms : kAnyTime)) {
    if (blobs.is_shared(mesh.id)) continue;
    remove(mesh, meshes, blobs);
    return true;
  }
  if (!job) return false;
  store.set_expired(job->id);
  blobs.remove(job->id);
  return true;
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
    meshes_.shift_kept_since(set_by_ms);
  }
  offset_ms_ = offset_ms;
  sweep(store_, blobs_, now_ms, keep_);
  sweep(meshes_, blobs_, now_ms, keep_);
}

}  // namespace unwrapd::server
