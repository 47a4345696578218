// The part of blob_store.hpp that sweeps the folders left by the last server.
#include <algorithm>
#include <functional>

#include "server/base/clock.hpp"
#include "server/base/identity.hpp"
#include "server/blobs/blob_store.hpp"

namespace unwrapd::server::blobs {
namespace {

namespace fs = std::filesystem;

void remove_unfinished(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_unfinished(entry.path())) remove_tree(entry.path());
  }
}

}  // namespace

Swept BlobStore::sweep(const Fates& fates, std::int64_t now_ms) {
  Swept swept;
  settle_attempts(fates);
  for (const fs::directory_entry& entry : fs::directory_iterator(incoming_))
    if (!may_be_at_work(entry.path(), server::now_ms())) remove_tree(entry.path());
  swept.returned =
      lost_.return_wanted([&](const std::string& name) { return fates(name) == FolderFate::kept; });
  if (copies_) {
    swept.removed = copies_->sweep(fates);
    return swept;
  }
  std::vector<fs::directory_entry> entries(fs::directory_iterator(blobs_), {});
  std::ranges::sort(entries, std::greater());  // meshes first: the documents count for them
  for (const fs::directory_entry& entry : entries) {
    try {
      sweep_one(entry, fates, now_ms, swept);
    } catch (const std::exception&) {  // one folder is no reason not to start
      swept.failed.push_back(entry.path().filename());
    }
  }
  return swept;
}

void BlobStore::sweep_one(const fs::directory_entry& entry, const Fates& fates, std::int64_t now_ms,
                          Swept& swept) {
  const std::string name = entry.path().filename();
  const FolderFate fate = fates(name);
  const bool is_folder = fs::is_directory(entry.symlink_status());
  if (fate == FolderFate::unknown && may_be_at_work(entry.path(), server::now_ms())) return;
  if (fate == FolderFate::unknown || !is_folder) {
    lost_.take(name, now_ms);
    swept.lost.push_back(name);
  } else if (fate == FolderFate::gone) {
    fs::remove_all(entry.path());
    ++swept.removed;
  } else {
    if (!may_be_at_work(entry.path(), server::now_ms())) remove_unfinished(entry.path());
    const bool shares = !is_shared_by_nodes() && !bytes_in(entry.path()).several.empty();
    const std::int64_t counted = bytes(name);
    if (shares && !is_mesh_id(name)) swept.sharing.emplace_back(name, counted);
  }
}

bool BlobStore::set_aside(const std::string& job, std::int64_t now_ms) {
  if (copies_) return is_file_name(job) && copies_->set_aside(job);
  if (!is_file_name(job) || !fs::exists(fs::symlink_status(blobs_ / job))) return false;
  lost_.take(job, now_ms);
  room_.give_back(job);
  const std::lock_guard lock(counting_);
  count_again(shared_.set(job, {}));
  return true;
}

}  // namespace unwrapd::server::blobs
