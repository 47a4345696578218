#include "server/blob_store.hpp"

#include <iterator>
#include <set>
#include <system_error>

#include "core/error.hpp"
#include "server/identity.hpp"

namespace unwrapd::server {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBufferPrefix = "buffer_";

/// What the sender brought: it stays as it came.
bool is_input(std::string_view file) {
  return file == kDocumentFile || file == kOptionsFile || file.starts_with(kBufferPrefix);
}

void remove_unfinished(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_unfinished(entry.path())) remove_tree(entry.path());
  }
}

std::vector<fs::path> chosen_files(const fs::path& folder,
                                   const std::function<bool(std::string_view)>& chosen) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    const bool is_content = name != kDigestsFile && !is_unfinished(entry.path());
    if (is_content && chosen(name)) files.push_back(entry.path());
  }
  return files;
}

/// Syncs the files that are chosen, and replaces their digests: by those that are known, or by
/// those of the bytes that are there. Digests have their name when all files are on the disk. The
/// folder is not synced.
void seal_files(const fs::path& folder, const std::function<bool(std::string_view)>& chosen,
                const Digests& known = {}) {
  const std::vector<fs::path> files = chosen_files(folder, chosen);
  Syncs syncs(files);
  Digests digests = read_digests(folder);
  std::erase_if(digests, [&](const auto& noted) { return chosen(noted.first); });
  for (const fs::path& file : files) {
    const std::string name = file.filename();
    const auto found = known.find(name);
    digests[name] = found != known.end() ? found->second : sha256_of(File::open(file));
  }
  write_digests(folder, digests, [&] { syncs.finish(); });
}

/// Whether a document has several names: a mesh's and those of the jobs that share it.
bool is_shared_file(const fs::path& file) {
  std::error_code gone;
  const std::uintmax_t names = fs::hard_link_count(file, gone);
  return !gone && names > 1;
}

std::int64_t bytes_below(const fs::path& folder) {
  const bool of_job = !is_mesh_id(folder.filename().native());
  std::int64_t bytes = 0;
  std::error_code gone;  // what somebody removes meanwhile counts nothing
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, gone)) {
    const std::string name = entry.path().filename();
    if (name == kDigestsFile) continue;  // ours, not the owner's
    if (of_job && is_input(name) && is_shared_file(entry.path())) continue;  // it counts there
    const std::uintmax_t size = entry.file_size(gone);
    if (!gone) bytes += static_cast<std::int64_t>(size);
  }
  return bytes;
}

/// The names of all results, whether noted or there: where both are not the same, not all is whole.
std::set<std::string> results_in(const fs::path& folder, const Digests& noted) {
  std::set<std::string> files;
  for (const auto& [file, digest] : noted)
    if (!is_input(file)) files.insert(file);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name != kDigestsFile && !is_unfinished(entry.path()) && !is_input(name)) files.insert(name);
  }
  return files;
}

/// Once: version 0.1.0 noted no digests. Every later one begins a folder with some, so that one
/// which has lost them is told from one that never had any.
void note_first_version(const fs::path& blobs, const fs::path& done) {
  if (fs::exists(done)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(blobs)) {
    const bool has_none = entry.is_directory() && !fs::exists(entry.path() / kDigestsFile);
    if (!has_none) continue;
    seal_files(entry.path(), [](std::string_view) { return true; });
    sync_directory(entry.path());
  }
  write_file(done, "Every folder of blobs/ has its file `digests`.\n");
}

[[noreturn]] void corrupt(std::string_view file) {
  throw Error(ErrorCode::storage_corrupt,
              "The stored file " + std::string(file) +
                  " is damaged: its SHA-256 is not one that was noted; send the job again.");
}

}  // namespace

std::string result_file(std::string_view format) { return "result." + std::string(format); }

std::string buffer_file(std::size_t k) { return std::string(kBufferPrefix) + std::to_string(k); }

BlobStore::BlobStore(const fs::path& data, const DiskLimits& limits)
    : incoming_(data / "incoming"), blobs_(data / "blobs"), room_(data, limits) {
  make_directories(incoming_);
  make_directories(blobs_);
  note_first_version(blobs_, data / "digests-noted");
}

fs::path BlobStore::begin_upload(std::string_view upload) {
  fs::path folder = incoming_ / upload;
  make_directories(folder);
  return folder;
}

void BlobStore::keep_upload(std::string_view upload, std::string_view job, const Digests& known) {
  seal_files(incoming_ / upload, is_input, known);
  rename_unsynced(incoming_ / upload, blobs_ / job);
  Syncs({blobs_ / job, blobs_, incoming_}).finish();
  room_.give_back(upload);
  room_.set(job, bytes_below(blobs_ / job));
}

void BlobStore::drop_upload(std::string_view upload) noexcept {
  if (!fs::exists(incoming_ / upload)) return;
  left_.remove(incoming_ / upload);
  room_.give_back(upload);
}

fs::path BlobStore::path(std::string_view job, std::string_view file) const {
  return blobs_ / job / file;
}

void BlobStore::write_unsealed(std::string_view job, std::string_view file,
                               std::string_view bytes) {
  const auto count = static_cast<std::int64_t>(bytes.size());
  room_.take(job, count);
  try {
    write_file_unsynced(path(job, file), bytes);
  } catch (...) {
    room_.put_back(job, count);
    throw;
  }
}

void BlobStore::remove(std::string_view job) noexcept {
  left_.remove(blobs_ / job);
  room_.give_back(job);
  room_.make_reserve();
}

bool BlobStore::share_document(std::string_view mesh, std::string_view upload) {
  std::error_code failed;
  fs::create_hard_link(path(mesh, kDocumentFile), incoming_ / upload / kDocumentFile, failed);
  if (!failed) return true;
  if (failed == std::errc::no_such_file_or_directory) return false;
  throw Error(ErrorCode::storage_failed,
              "The store cannot give one more job a share of this mesh (" + failed.message() +
                  "); send the mesh itself with the job.");
}

bool BlobStore::is_shared(std::string_view mesh) const noexcept {
  return is_shared_file(path(mesh, kDocumentFile));
}

bool BlobStore::has(std::string_view job, std::string_view file) const {
  return read_digests(blobs_ / job).contains(file);
}

std::int64_t BlobStore::bytes(std::string_view job) const { return bytes_below(blobs_ / job); }

std::int64_t BlobStore::seal(std::string_view job) {
  const std::lock_guard lock(noting_);
  seal_files(blobs_ / job, [](std::string_view file) { return !is_input(file); });
  sync_directory(blobs_ / job);
  const std::int64_t bytes = bytes_below(blobs_ / job);
  room_.set(job, bytes);
  return bytes;
}

void BlobStore::note(std::string_view job, const std::string& file) {
  const std::lock_guard lock(noting_);
  Digests digests = read_digests(blobs_ / job);
  digests[file] = sha256_of(File::open(path(job, file)));
  write_digests(blobs_ / job, digests);
  sync_directory(blobs_ / job);
  if (keeping_.kept) keeping_.kept(job, bytes_below(blobs_ / job));
}

bool BlobStore::try_keep(std::string_view job, const std::string& file, std::string_view bytes) {
  const auto count = static_cast<std::int64_t>(bytes.size());
  std::shared_ptr<void> claim;  // until the bytes count
  if (keeping_.claim && !(claim = keeping_.claim(std::string(job), count))) return false;
  if (!room_.try_take(job, count)) return false;
  try {
    write_file(path(job, file), bytes);
    note(job, file);
    return true;
  } catch (const Error& error) {
    remove_tree(path(job, file));
    room_.put_back(job, count);
    if (error.code() == ErrorCode::storage_full) return false;
    throw;
  }
}

std::shared_ptr<const File> BlobStore::lend(std::string_view bytes) const {
  room_.check_free(static_cast<std::int64_t>(bytes.size()));
  const fs::path path = incoming_ / ("lent_" + random_job_id());
  try {
    write_file_unsynced(path, bytes);
    auto lent = std::make_shared<const File>(File::open(path));
    remove_tree(path);
    return lent;
  } catch (...) {
    remove_tree(path);
    throw;
  }
}

bool BlobStore::holds(std::string_view job) const { return fs::exists(blobs_ / job); }

/// What is checked is the link: it stays what it is when the other's file is made again meanwhile.
bool BlobStore::adopt(std::string_view job, std::string_view from) noexcept {
  Digests adopted;
  try {
    const Digests theirs = read_digests(blobs_ / from);
    if (!theirs.contains(kReportFile)) return false;
    for (const std::string& file : results_in(blobs_ / from, theirs)) {
      adopted[file] = theirs.at(file);
      fs::create_hard_link(path(from, file), path(job, file));
      if (!checked_.is_whole(File::open(path(job, file)), theirs.at(file))) corrupt(file);
    }
    Digests digests = read_digests(blobs_ / job);
    digests.merge(Digests(adopted));
    write_digests(blobs_ / job, digests);
    sync_directory(blobs_ / job);
    room_.set(job, bytes_below(blobs_ / job));
    return true;
  } catch (const std::exception&) {  // then the job is run like any other
    for (const auto& [file, digest] : adopted) remove_tree(path(job, file));
    return false;
  }
}

std::shared_ptr<const File> BlobStore::open(std::string_view job, std::string_view file) const {
  auto opened = std::make_shared<const File>(File::open(path(job, file)));
  const Digests digests = read_digests(blobs_ / job);
  const auto noted = digests.find(file);
  if (noted == digests.end() || !checked_.is_whole(*opened, noted->second)) corrupt(file);
  return opened;
}

std::string BlobStore::read(std::string_view job, std::string_view file) const {
  std::string bytes = read_file(path(job, file));
  const Digests digests = read_digests(blobs_ / job);
  const auto noted = digests.find(file);
  if (noted == digests.end() || noted->second != sha256(bytes)) corrupt(file);
  return bytes;
}

std::string BlobStore::digest(std::string_view job, std::string_view file) const {
  const Digests digests = read_digests(blobs_ / job);
  const auto noted = digests.find(file);
  return noted != digests.end() ? noted->second : sha256_of(File::open(path(job, file)));
}

int BlobStore::folder_count() const {
  return static_cast<int>(std::distance(fs::directory_iterator(blobs_), fs::directory_iterator()));
}

int BlobStore::sweep(const std::function<bool(const std::string& job)>& keeps_files) {
  int removed = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(incoming_))
    remove_tree(entry.path());
  for (const fs::directory_entry& entry : fs::directory_iterator(blobs_)) {
    const std::string job = entry.path().filename();
    if (!keeps_files(job)) {
      remove_tree(entry.path());
      ++removed;
      continue;
    }
    remove_unfinished(entry.path());
    room_.set(job, bytes_below(entry.path()));
  }
  return removed;
}

}  // namespace unwrapd::server
