#include "server/backup/backup.hpp"

#include <algorithm>
#include <iterator>
#include <system_error>

#include "api/json.hpp"
#include "core/base/error.hpp"
#include "server/access/key_store.hpp"
#include "server/access/signed_link.hpp"
#include "server/backup/folder_copy.hpp"
#include "server/base/clock.hpp"
#include "server/base/errors.hpp"
#include "server/base/files.hpp"
#include "server/base/identity.hpp"
#include "server/database/schema.hpp"
#include "server/database/sqlite_database.hpp"
#include "server/store/data_directory.hpp"
#include "server/store/job_rows.hpp"

namespace unwrapd::server::backup {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBlobs = "blobs";
constexpr const char* kLock = "lock";
constexpr const char* kNotedFile = "digests-noted";
constexpr std::int64_t kRowsAtOnce = 1000;

void require_store(const fs::path& data) {
  if (fs::is_regular_file(data / store::kStoreFile)) return;
  throw Error(ErrorCode::not_found, "There is no " + (data / store::kStoreFile).string() +
                                        "; give the --data directory of a server.");
}

[[noreturn]] void not_whole(const fs::path& backup, const std::string& why) {
  throw Error(ErrorCode::storage_corrupt,
              backup.string() + " is not a complete backup: " + why + ". Nothing was restored.");
}

void add_counts(const FolderCopy& copy, StoreReport& report) {
  report.jobs = copy.counts().folders;
  report.files = copy.counts().files;
  report.bytes = copy.counts().bytes;
}

/// The folders of the copied rows; the rows of those that ended or went meanwhile are left out.
void copy_folders(const database::Database& live, database::Database& copied, const fs::path& data,
                  const fs::path& to, StoreReport& report) {
  FolderCopy copy(data / kBlobs, to / kBlobs);
  std::int64_t gone = 0;
  for (const KnownFolder& folder : known_folders(copied)) {
    const std::vector<std::string> damaged = copy.take(folder);
    if (damaged.empty()) continue;
    if (is_known(live, folder.name)) {
      report.damaged.insert(report.damaged.end(), damaged.begin(), damaged.end());
      continue;
    }
    remove_tree(to / kBlobs / folder.name);
    database::Statement(copied, "DELETE FROM jobs WHERE id = ?").with(folder.name).run();
    database::Statement(copied, "DELETE FROM meshes WHERE id = ?").with(folder.name).run();
    ++gone;
  }
  add_counts(copy, report);
  if (gone > 0)
    report.notices.push_back(std::to_string(gone) +
                             " jobs and meshes were deleted during the backup, and are not in it");
}

/// Returns the digests of what lies beside blobs.
api::Json copy_beside(const fs::path& data, const fs::path& to) {
  api::Json digests = api::Json::object();
  for (const char* file : {access::kSecretFile, kNotedFile})
    if (fs::exists(data / file)) digests[file] = copy_private(data / file, to / file);
  if (fs::exists(data / access::kKeysFile))
    database::SqliteDatabase(data / access::kKeysFile).copy_to(to / access::kKeysFile);
  for (const char* file : {store::kStoreFile, access::kKeysFile}) {
    if (!fs::exists(to / file)) continue;
    fs::permissions(to / file, fs::perms::owner_read | fs::perms::owner_write);
    digests[file] = blobs::sha256_of(File::open(to / file));
  }
  return digests;
}

void make_backup(const fs::path& data, const fs::path& to, StoreReport& report) {
  const database::SqliteDatabase live(data / store::kStoreFile);
  live.copy_to(to / store::kStoreFile);
  {
    database::SqliteDatabase copied(to / store::kStoreFile);
    copied.check(true);
    copy_folders(live, copied, data, to, report);
    copied.run("UPDATE jobs SET state = 'queued', lease_ms = 0 WHERE state = 'running'");
    copied.run("PRAGMA journal_mode = DELETE");
  }
  api::Json manifest = {{"unwrapd", UNWRAPD_VERSION}, {"created", rfc3339(now_ms())},
                        {"files", report.files},      {"bytes", report.bytes},
                        {"damaged", report.damaged},  {"sha256", copy_beside(data, to)}};
  write_file(to / kManifestFile, manifest.dump(2) + "\n");
  sync_all(to);
}

api::Json read_manifest(const fs::path& backup) {
  if (!fs::is_regular_file(backup / kManifestFile))
    not_whole(backup, "it has no " + std::string(kManifestFile) + ", which is written last");
  api::Json manifest = api::Json::parse(read_file(backup / kManifestFile), nullptr, false);
  const bool is_ours = manifest.is_object() && manifest.contains("sha256") &&
                       manifest["sha256"].is_object() && manifest.contains("files") &&
                       manifest["files"].is_number_integer() && manifest.contains("damaged") &&
                       manifest["damaged"].is_array();
  if (!is_ours) not_whole(backup, std::string(kManifestFile) + " is damaged");
  return manifest;
}

/// Whether the files beside blobs are those of the manifest.
void check_beside(const fs::path& backup, const api::Json& manifest) {
  if (!manifest["sha256"].contains(store::kStoreFile))
    not_whole(backup, std::string(kManifestFile) + " does not name " + store::kStoreFile);
  for (const auto& [file, digest] : manifest["sha256"].items()) {
    const bool is_whole = is_file_name(file) && fs::is_regular_file(backup / file) &&
                          digest == blobs::sha256_of(File::open(backup / file));
    if (!is_whole) not_whole(backup, file + " is missing or damaged");
  }
}

/// Whether a folder was found damaged when the backup was made, and its rest alone is there.
bool was_told(const api::Json& manifest, const std::string& damage) {
  const std::string folder = damage.substr(0, damage.find_first_of("/ "));
  return std::ranges::any_of(manifest["damaged"], [&](const api::Json& told) {
    return told.is_string() && told.get_ref<const std::string&>().starts_with(folder);
  });
}

/// Throws unless all is there that the backup says that it has.
void check_backup(const fs::path& backup) {
  const api::Json manifest = read_manifest(backup);
  check_beside(backup, manifest);
  const database::SqliteDatabase store(backup / store::kStoreFile,
                                       database::SqliteDatabase::Access::read);
  database::refuse_newer(store);
  store.check(true);
  FolderCopy look(backup / kBlobs);
  for (const KnownFolder& folder : known_folders(store))
    for (const std::string& what : look.take(folder))
      if (!was_told(manifest, what)) not_whole(backup, what);
  if (look.counts().files != manifest["files"]) not_whole(backup, "files of jobs are missing");
}

/// The rows that cannot be read.
void check_rows(const database::Database& store, StoreReport& report) {
  for (std::int64_t last = 0;;) {
    database::Statement rows(store, store::select_jobs("WHERE seq > ? ORDER BY seq LIMIT ?"));
    const std::vector<store::JobRecord> jobs = store::job_rows(rows.with(last, kRowsAtOnce));
    if (jobs.empty()) return;
    for (const store::JobRecord& job : jobs)
      if (!job.unreadable.empty()) report.damaged.push_back(job.id + ": " + job.unreadable);
    last = jobs.back().seq;
  }
}

/// Folders that the next start will set aside. One whose row is about to come is no such.
void note_unknown(const fs::path& data, const database::Database& store, StoreReport& report) {
  std::error_code none;
  std::int64_t unknown = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(data / kBlobs, none)) {
    const std::string name = entry.path().filename();
    database::Statement row(store,
                            "SELECT 1 FROM (SELECT id FROM jobs UNION ALL SELECT id FROM meshes)"
                            " WHERE id = ?");
    if (!row.with(name).step() && fs::exists(entry.path(), none)) ++unknown;
  }
  if (unknown > 0)
    report.notices.push_back(std::to_string(unknown) +
                             " folders in blobs have no row in the database");
  const auto lost =
      std::distance(fs::directory_iterator(data / "lost", none), fs::directory_iterator());
  if (lost > 0) report.notices.push_back(std::to_string(lost) + " folders are set aside in lost");
}

void check_database(const database::SqliteDatabase& database, StoreReport& report) {
  try {
    database.check(true);
  } catch (const Error& error) {
    report.damaged.push_back(reason_of(error));
  }
}

/// Whether a path is a folder or lies in it; links are resolved.
bool lies_in(const fs::path& path, const fs::path& folder) {
  const fs::path inner = fs::weakly_canonical(path), outer = fs::weakly_canonical(folder);
  return std::ranges::mismatch(outer, inner).in1 == outer.end();
}

/// Throws if a directory has anything but the lock of a server.
void require_empty(const fs::path& data) {
  if (!fs::is_directory(data)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(data)) {
    if (entry.path().filename() == kLock) continue;
    throw Error(ErrorCode::invalid_option,
                data.string() + " is not empty: it has " + entry.path().filename().string() +
                    "; move its files away first, or give another --data directory.");
  }
}

}  // namespace

StoreReport back_up(const fs::path& data, const fs::path& to) {
  require_store(data);
  if (lies_in(to, data))
    throw Error(ErrorCode::invalid_option,
                to.string() +
                    " lies in the data directory, and the server removes unknown files there; name "
                    "a folder outside of it.");
  database::require_current(database::SqliteDatabase(data / store::kStoreFile));
  const fs::path part = fs::path(to) += ".part";
  for (const fs::path& there : {to, part}) {
    if (!fs::exists(fs::symlink_status(there))) continue;
    throw Error(ErrorCode::invalid_option,
                there.string() + " exists already; remove it, or name another folder.");
  }
  StoreReport report;
  try {
    make_directories(part / kBlobs);
    fs::permissions(part, fs::perms::owner_all);
    make_backup(data, part, report);
    rename_unsynced(part, to);
    sync_directory(fs::absolute(to).parent_path());
  } catch (...) {
    remove_tree(part);
    throw;
  }
  return report;
}

StoreReport restore(const fs::path& backup, const fs::path& data) {
  check_backup(backup);
  if (!fs::exists(data / kLock)) require_empty(data);  // a refusal leaves no lock behind
  const store::DataLock lock(data);
  require_empty(data);
  StoreReport report;
  make_directories(data / kBlobs);
  FolderCopy copy(backup / kBlobs, data / kBlobs);
  const database::SqliteDatabase store(backup / store::kStoreFile,
                                       database::SqliteDatabase::Access::read);
  for (const KnownFolder& folder : known_folders(store))
    for (std::string& what : copy.take(folder)) report.damaged.push_back(std::move(what));
  add_counts(copy, report);
  for (const char* file : {kNotedFile, access::kSecretFile, access::kKeysFile,
                           store::kStoreFile})  // what starts it: last
    if (fs::exists(backup / file)) copy_private(backup / file, data / file);
  sync_all(data);
  return report;
}

StoreReport check_store(const fs::path& data) {
  require_store(data);
  StoreReport report;
  const bool is_backup = fs::exists(data / kManifestFile);
  const auto access =
      is_backup ? database::SqliteDatabase::Access::read : database::SqliteDatabase::Access::write;
  if (is_backup) check_beside(data, read_manifest(data));
  const database::SqliteDatabase store(data / store::kStoreFile, access);
  check_database(store, report);
  if (fs::exists(data / access::kKeysFile))
    check_database(database::SqliteDatabase(data / access::kKeysFile, access), report);
  if (!report.damaged.empty()) return report;  // what it says of the files means nothing
  database::require_current(store);
  check_rows(store, report);
  FolderCopy look(data / kBlobs);
  for (const KnownFolder& folder : known_folders(store)) {
    const std::vector<std::string> damaged = look.take(folder);
    if (!damaged.empty() && is_known(store, folder.name))
      report.damaged.insert(report.damaged.end(), damaged.begin(), damaged.end());
  }
  add_counts(look, report);
  note_unknown(data, store, report);
  return report;
}

}  // namespace unwrapd::server::backup
