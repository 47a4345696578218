#include "server/store/sweeper.hpp"

#include <algorithm>
#include <limits>

#include "server/base/identity.hpp"

namespace unwrapd::server::store {
namespace {

constexpr std::chrono::seconds kLongestPause{60};
constexpr int kSweepsInTime = 8;  // while a result is kept, at least
constexpr std::size_t kNamesTold = 20;
constexpr auto kAnyTime = std::numeric_limits<std::int64_t>::max();

/// Removes the row first: files without a row are swept if the rest fails.
void remove(const MeshRecord& mesh, MeshStore& meshes, blobs::BlobStore& blobs) {
  blobs.room().free_by([&] { meshes.remove(mesh.id); });
  blobs.remove(mesh.id);
}

void expire(const std::string& job, JobStore& store, blobs::BlobStore& blobs) {
  blobs.room().free_by([&] { store.set_expired(job); });
  blobs.remove(job);
}

void tell_swept(const blobs::Swept& swept, const Log& log) {
  if (swept.removed > 0) log.info("folders of ended jobs removed", {{"folders", swept.removed}});
  if (swept.returned > 0)
    log.warning("folders returned from lost, their jobs are in the database again",
                {{"folders", swept.returned}});
  const auto tell = [&](std::string_view what, const std::vector<std::string>& names) {
    if (names.empty()) return;
    const std::size_t told = std::min(names.size(), kNamesTold);
    log.warning(what,
                {{"folders", names.size()},
                 {"names", std::vector(names.begin(), names.begin() + std::ptrdiff_t(told))}});
  };
  tell("folders of no job set aside in lost", swept.lost);
  tell("folders that can neither be read nor moved", swept.failed);
}

}  // namespace

void sweep_at_start(JobStore& store, MeshStore& meshes, blobs::BlobStore& blobs, const Log& log) {
  const blobs::Swept swept = blobs.sweep(
      [&](const std::string& name) {
        if (!is_mesh_id(name)) return store.fate_of(name);
        return meshes.has(name) ? blobs::FolderFate::kept : blobs::FolderFate::unknown;
      },
      store.now().kept_ms());
  tell_swept(swept, log);
  store.mend_stored_bytes(swept.sharing);
}

void sweep(JobStore& store, blobs::BlobStore& blobs, std::int64_t now_ms,
           std::chrono::seconds keep) {
  const std::int64_t keep_ms = std::chrono::milliseconds(keep).count();
  for (const std::string& job : store.finished_before(now_ms - keep_ms)) expire(job, store, blobs);
  blobs.room().free_by([&] { store.forget_before(now_ms - 2 * keep_ms); });
}

void sweep(MeshStore& meshes, blobs::BlobStore& blobs, std::int64_t now_ms,
           std::chrono::seconds keep) {
  const std::int64_t keep_ms = std::chrono::milliseconds(keep).count();
  for (const MeshRecord& mesh : meshes.unused_since(now_ms - keep_ms)) {
    if (!blobs.is_shared(mesh.id)) remove(mesh, meshes, blobs);
  }
}

bool evict_oldest(JobStore& store, MeshStore& meshes, blobs::BlobStore& blobs) {
  if (blobs.lost().give_up_first()) return true;
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

/// On a full disk, a later sweep or the next start tries again.
void Sweeper::note_time() {
  try {
    if (const std::int64_t by_ms = store_.note_time(); by_ms != 0)
      log_.warning("the system clock was changed", {{"by_ms", by_ms}});
  } catch (const Error& error) {
    if (error.code() != ErrorCode::storage_full) throw;
  }
}

void Sweeper::sweep_once() {
  note_time();
  const std::int64_t now_ms = store_.now().kept_ms();
  sweep(store_, blobs_, now_ms, keep_);
  sweep(meshes_, blobs_, now_ms, keep_);
  const std::int64_t kept_since_ms = now_ms - std::chrono::milliseconds(keep_).count();
  if (const int lost = blobs_.lost().sweep(kept_since_ms); lost > 0)
    log_.warning("folders in lost expired and are removed", {{"folders", lost}});
  blobs_.room().make_reserve();
}

}  // namespace unwrapd::server::store
