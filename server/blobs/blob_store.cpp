#include "server/blobs/blob_store.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <system_error>

#include "core/base/error.hpp"
#include "server/base/identity.hpp"

namespace unwrapd::server::blobs {
namespace {

namespace fs = std::filesystem;

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

/// Throws Error{storage_corrupt} for a file of which nothing is there.
void check_there(const fs::path& path) {
  std::error_code gone;
  if (fs::is_regular_file(path, gone)) return;
  throw Error(ErrorCode::storage_corrupt,
              "The stored file " + path.filename().string() + " is missing; send the job again.");
}

[[noreturn]] void corrupt(std::string_view file) {
  throw Error(ErrorCode::storage_corrupt,
              "The stored file " + std::string(file) +
                  " is damaged: its SHA-256 is not the recorded one; send the job again.");
}

}  // namespace

BlobStore::BlobStore(const fs::path& data, const DiskLimits& limits, Sharing sharing)
    : sharing_(sharing),
      incoming_(data / "incoming"),
      blobs_(data / "blobs"),
      room_(data, limits),
      lost_(data, room_) {
  make_directories(incoming_);
  make_directories(blobs_);
  const std::shared_ptr<void> locked = lock_folder({});
  note_first_version(blobs_, data / "digests-noted");
}

fs::path BlobStore::begin_upload(std::string_view upload) {
  fs::path folder = incoming_ / upload;
  make_directories(folder);
  return folder;
}

void BlobStore::keep_upload(std::string_view upload, std::string_view job, const Digests& known) {
  seal_files(incoming_ / upload, is_input, known);
  if (copies_) keep_in_bucket(upload, job);
  rename_unsynced(incoming_ / upload, blobs_ / job);
  Syncs({blobs_ / job, blobs_, incoming_}).finish();
  room_.give_back(upload);
  const std::lock_guard lock(counting_);
  count(std::string(job));
}

/// Counts the files of a folder and those that it shares, and returns its bytes.
std::int64_t BlobStore::count(const std::string& name) {
  const FolderBytes bytes = bytes_in(blobs_ / name);
  std::set<SharedFiles::Inode> several;
  for (const auto& [file, size] : bytes.several) several.insert(file);
  const std::vector<std::string> changed = shared_.set(name, several);
  std::int64_t all = bytes.alone;
  for (const auto& [file, size] : bytes.several)
    if (is_shared_by_nodes() || shared_.counts_for(name, file)) all += size;
  room_.set(name, all);
  if (!is_shared_by_nodes()) count_again(changed);
  return all;
}

/// Files that they share count for others of them now.
void BlobStore::count_again(const std::vector<std::string>& holders) {
  for (const std::string& holder : holders) {
    const std::int64_t bytes = count(holder);
    try {
      if (keeping_.kept) keeping_.kept(holder, bytes);
    } catch (const Error&) {  // a row that is not told is mended at the next start
    }
  }
}

void BlobStore::drop_upload(std::string_view upload) noexcept {
  if (!fs::exists(incoming_ / upload)) return;
  left_.remove(incoming_ / upload);
  room_.give_back(upload);
}

fs::path BlobStore::path(std::string_view job, std::string_view file) const {
  bring(job, file);
  return place(job, file);
}

fs::path BlobStore::place(std::string_view job, std::string_view file) const {
  return blobs_ / job / file;
}

void BlobStore::write_unsealed(std::string_view job, int attempt, std::string_view file,
                               std::string_view bytes) {
  const auto count = static_cast<std::int64_t>(bytes.size());
  room_.take(job, count);
  try {
    if (is_shared_by_nodes()) make_directories(work_folder(job, attempt));
    write_file_unsynced(work_folder(job, attempt) / file, bytes);
  } catch (...) {
    room_.put_back(job, count);
    throw;
  }
}

void BlobStore::remove(std::string_view job) noexcept {
  if (!is_file_name(job)) return;  // of a damaged row
  if (copies_) remove_in_bucket(job);
  left_.remove(blobs_ / job);
  room_.give_back(job);
  room_.make_reserve();
  const std::lock_guard lock(counting_);
  count_again(shared_.set(std::string(job), {}));
}

bool BlobStore::share_document(std::string_view mesh, std::string_view upload) {
  bring(mesh, kDocumentFile);
  std::error_code failed;
  fs::create_hard_link(place(mesh, kDocumentFile), incoming_ / upload / kDocumentFile, failed);
  if (!failed) {
    const std::lock_guard lock(counting_);
    count(std::string(mesh));  // for it, and for the job from keep_upload() on
    return true;
  }
  if (failed == std::errc::no_such_file_or_directory) return false;
  throw Error(ErrorCode::storage_failed, "The store cannot share this mesh with one more job (" +
                                             failed.message() +
                                             "); send the mesh itself with the job.");
}

bool BlobStore::is_shared(std::string_view mesh) const {
  if (copies_) return false;  // each folder has an object of its own
  const std::lock_guard lock(counting_);
  const FolderBytes bytes = bytes_in(blobs_ / mesh);
  if (is_shared_by_nodes()) return !bytes.several.empty();
  return std::ranges::any_of(bytes.several, [&](const auto& file) {
    return shared_.has_others(std::string(mesh), file.first);
  });
}

bool BlobStore::has(std::string_view job, std::string_view file) const {
  bring(job, file);
  return read_digests(blobs_ / job).contains(file);
}

std::int64_t BlobStore::bytes(std::string_view job) {
  const std::lock_guard lock(counting_);
  return count(std::string(job));
}

std::int64_t BlobStore::seal(std::string_view job, int attempt) {
  const fs::path folder = work_folder(job, attempt);
  {
    const std::lock_guard lock(noting_);
    seal_files(folder, [](std::string_view file) { return !is_input(file); });
    sync_directory(folder);
  }
  if (copies_) return seal_in_bucket(job, attempt, folder);
  const std::int64_t in_place = bytes(job);
  return is_shared_by_nodes() ? in_place + bytes_in(folder).alone : in_place;
}

void BlobStore::note(std::string_view job, const std::string& file) {
  const std::lock_guard lock(noting_);
  const std::shared_ptr<void> locked = lock_folder(job);
  Digests digests = read_digests(blobs_ / job);
  digests[file] = sha256_of(File::open(place(job, file)));
  write_digests(blobs_ / job, digests);
  sync_directory(blobs_ / job);
  if (copies_) return;  // it counts for nobody
  const std::int64_t counted = bytes(job);
  if (keeping_.kept) keeping_.kept(job, counted);
}

bool BlobStore::try_keep(std::string_view job, const std::string& file, std::string_view bytes,
                         std::int64_t seq) {
  const auto count = static_cast<std::int64_t>(bytes.size());
  if (copies_) return keep_copy(job, file, bytes);
  std::shared_ptr<void> reservation;  // until the bytes count
  if (keeping_.reservation && !(reservation = keeping_.reservation(std::string(job), seq, count)))
    return false;
  if (!room_.try_take(job, count)) return false;
  try {
    write_file(place(job, file), bytes);
    note(job, file);
    return true;
  } catch (const Error& error) {
    remove_tree(place(job, file));
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

bool BlobStore::holds(std::string_view job) const {
  return copies_ ? copies_->bucket().has_input(job) : fs::exists(blobs_ / job);
}

/// What is checked is the link: it stays what it is when the other's file is made again meanwhile.
bool BlobStore::adopt(std::string_view job, std::string_view from) noexcept {
  Digests adopted;
  try {
    if (copies_) copies_->bring_results(from);
    const Digests theirs = read_digests(blobs_ / from);
    if (!theirs.contains(kReportFile)) return false;
    for (const std::string& file : results_in(blobs_ / from, theirs)) {
      adopted[file] = theirs.at(file);
      fs::create_hard_link(place(from, file), place(job, file));
      if (!checked_.is_whole(File::open(place(job, file)), theirs.at(file))) corrupt(file);
    }
    if (copies_ && !copies_->bucket().copy_results(copies_->root(job), copies_->root(from)))
      corrupt(kReportFile);
    Digests digests = read_digests(blobs_ / job);
    digests.merge(Digests(adopted));
    write_digests(blobs_ / job, digests);
    sync_directory(blobs_ / job);
    const std::lock_guard counting(counting_);
    count(std::string(from));  // for it, while it is there
    count(std::string(job));
    return true;
  } catch (const std::exception&) {  // then the job is run like any other
    for (const auto& [file, digest] : adopted) remove_tree(place(job, file));
    return false;
  }
}

std::shared_ptr<const File> BlobStore::open(std::string_view job, std::string_view file) const {
  for (bool is_again = false;; is_again = true) {
    check_there(path(job, file));
    auto opened = std::make_shared<const File>(File::open(place(job, file)));
    const Digests digests = read_digests(blobs_ / job);
    const auto noted = digests.find(file);
    if (noted != digests.end() && checked_.is_whole(*opened, noted->second)) return opened;
    if (!copies_ || is_again) corrupt(file);
    copies_->forget_file(job, file);
  }
}

std::string BlobStore::read(std::string_view job, std::string_view file) const {
  for (bool is_again = false;; is_again = true) {
    check_there(path(job, file));
    std::string bytes = read_file(place(job, file));
    const Digests digests = read_digests(blobs_ / job);
    const auto noted = digests.find(file);
    if (noted != digests.end() && noted->second == sha256(bytes)) return bytes;
    if (!copies_ || is_again) corrupt(file);
    copies_->forget_file(job, file);
  }
}

std::string BlobStore::digest(std::string_view job, std::string_view file) const {
  bring(job, file);
  const Digests digests = read_digests(blobs_ / job);
  const auto noted = digests.find(file);
  return noted != digests.end() ? noted->second : sha256_of(File::open(place(job, file)));
}

int BlobStore::folder_count() const {
  if (copies_) return int{copies_->bucket().has_any()};
  return static_cast<int>(std::distance(fs::directory_iterator(blobs_), fs::directory_iterator()));
}

}  // namespace unwrapd::server::blobs
