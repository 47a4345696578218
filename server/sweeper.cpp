#include "server/sweeper.hpp"

#include <algorithm>
#include <limits>

namespace unwrapd::server {
namespace {

constexpr std::chrono::seconds kLongestPause{60};
constexpr int kSweepsInTime = 8;  // while a result is kept, at least
constexpr auto kAnyTime = std::numeric_limits<std::int64_t>::max();

/// The row first: what has none is swept, should the rest of it not come about.
void remove(const MeshRecord& mesh, MeshStore& meshes, BlobStore& blobs) {
  blobs.room().free_by([&] { meshes.remove(mesh.id); });
  blobs.remove(mesh.id);
}

void expire(const std::string& job, JobStore& store, BlobStore& blobs) {
  blobs.room().free_by([&] { store.set_expired(job); });
  blobs.remove(job);
}

}  // namespace

void sweep(JobStore& store, BlobStore& blobs, std::int64_t now_ms, std::chrono::seconds keep) {
  const std::int64_t keep_ms = std::chrono::milliseconds(keep).count();
  for (const std::string& job : store.finished_before(now_ms - keep_ms)) expire(job, store, blobs);
  blobs.room().free_by([&] { store.forget_before(now_ms - 2 * keep_ms); });
}

void sweep(MeshStore& meshes, BlobStore& blobs, std::int64_t now_ms, std::chrono::seconds keep) {
  const std::int64_t keep_ms = std::chrono::milliseconds(keep).count();
  for (const MeshRecord& mesh : meshes.unused_since(now_ms - keep_ms)) {
    if (!blobs.is_shared(mesh.id)) remove(mesh, meshes, blobs);
  }
}

bool evict_oldest(JobStore& store, MeshStore& meshes, BlobStore& blobs) {
  const std::vector<std::string> finished = store.finished_before(kAnyTime, 1);
  for (const MeshRecord& mesh : meshes.unused_since(kAnyTime)) {
    if (!store.finished_before(mesh.kept_since_ms + 1, 1).empty()) break;
    if (blobs.is_shared(mesh.id)) continue;
    remove(mesh, meshes, blobs);
    return true;
  }
  if (finished.empty()) return false;
  expire(finished.front(), store, blobs);
  return true;
}

std::chrono::milliseconds Sweeper::pause() const {
  return std::min<std::chrono::milliseconds>(std::chrono::milliseconds(keep_) / kSweepsInTime,
                                             kLongestPause);
}

void Sweeper::sweep_once() {
  blobs_.room().free_by([&] {
    if (const std::int64_t by_ms = store_.note_time(); by_ms != 0)
      log_.warning("the time of day was set", {{"by_ms", by_ms}});
  });
  const std::int64_t now_ms = store_.now().kept_ms();
  sweep(store_, blobs_, now_ms, keep_);
  sweep(meshes_, blobs_, now_ms, keep_);
  blobs_.room().make_reserve();
}

}  // namespace unwrapd::server
