#include "server/backup/folder_copy.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "core/base/error.hpp"
#include "server/base/files.hpp"
#include "server/base/identity.hpp"
#include "server/blobs/blob_files.hpp"

namespace unwrapd::server::backup {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
constexpr int kMostLooks = 3;
constexpr const char* kKnown =
    "SELECT id, state <> 'succeeded' FROM jobs"
    " WHERE expired = 0 AND state IN ('queued', 'running', 'succeeded')"
    " UNION ALL SELECT id, 0 FROM meshes";

template <class Use>
void each_piece(const File& file, const Use& use) {
  for (std::int64_t offset = 0;;) {
    const std::string piece = file.read(offset, kPieceBytes);
    if (piece.empty()) return;
    use(piece);
    offset += static_cast<std::int64_t>(piece.size());
  }
}

}  // namespace

std::vector<KnownFolder> known_folders(const database::Database& store) {
  database::Statement rows(store, std::string(kKnown) + " ORDER BY 1");
  std::vector<KnownFolder> found;
  while (rows.step())
    if (std::string name = rows.text(0); is_file_name(name))
      found.push_back({.name = std::move(name), .inputs_only = rows.number(1) != 0});
  return found;
}

bool is_known(const database::Database& store, const std::string& name) {
  database::Statement rows(store, "SELECT 1 FROM (" + std::string(kKnown) + ") WHERE id = ?");
  return rows.with(name).step();
}

/// Returns the SHA-256 of the bytes.
std::string FolderCopy::copy_bytes(const fs::path& from, const fs::path& to) {
  const File source = File::open(from);
  Sha256 hash;
  if (to_.empty()) {
    each_piece(source, [&](const std::string& piece) { hash.add(piece); });
    return hash.finish();
  }
  remove_tree(to);  // of a look before this one
  File copy = File::create(to);
  each_piece(source, [&](const std::string& piece) {
    hash.add(piece);
    copy.append(piece);
  });
  copy.begin_sync();
  return hash.finish();
}

/// Returns what is wrong with it, or nothing.
std::string FolderCopy::take_file(const std::string& folder, const std::string& file,
                                  const std::string& digest) {
  const fs::path from = from_ / folder / file;
  const fs::path to = to_ / folder / file;
  struct stat status {};
  if (::lstat(from.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return " is missing";
  const auto seen = several_.find(status.st_ino);
  if (status.st_nlink > 1 && seen != several_.end() && seen->second.digest == digest) {
    remove_tree(to);
    if (!to_.empty()) fs::create_hard_link(seen->second.path, to);
    return {};
  }
  if (copy_bytes(from, to) != digest) {
    if (!to_.empty()) remove_tree(to);
    return " is damaged: its SHA-256 is not the recorded one";
  }
  if (status.st_nlink > 1) several_[status.st_ino] = {.digest = digest, .path = to};
  return {};
}

std::vector<std::string> FolderCopy::take_once(const KnownFolder& folder, FolderCounts& counts) {
  std::vector<std::string> damaged;
  blobs::Digests digests = blobs::read_digests(from_ / folder.name);
  if (digests.empty()) return {folder.name + "/digests is missing"};
  if (folder.inputs_only)
    std::erase_if(digests, [](const auto& f) { return !blobs::is_input(f.first); });
  if (!to_.empty()) make_directories(to_ / folder.name);
  blobs::Digests taken;
  for (const auto& [file, digest] : digests) {
    const std::string wrong =
        is_file_name(file) ? take_file(folder.name, file, digest) : " is not a file name";
    if (!wrong.empty()) {
      damaged.push_back(folder.name + "/" + file + wrong);
      continue;
    }
    taken[file] = digest;
    ++counts.files;
    counts.bytes += static_cast<std::int64_t>(fs::file_size(from_ / folder.name / file));
  }
  if (!to_.empty())
    write_file_unsynced(to_ / folder.name / blobs::kDigestsFile, blobs::to_text(taken));
  return damaged;
}

std::vector<std::string> FolderCopy::take(const KnownFolder& folder) {
  std::vector<std::string> damaged;
  for (int look = 1; look <= kMostLooks; ++look) {
    FolderCounts counts;
    try {
      damaged = take_once(folder, counts);
    } catch (const fs::filesystem_error&) {  // gone between two looks
      damaged = {folder.name + " cannot be read"};
    } catch (const Error& error) {
      if (error.code() == ErrorCode::storage_full) throw;
      damaged = {folder.name + " cannot be read: " + error.what()};
    }
    if (!damaged.empty() && look < kMostLooks) continue;
    ++counts_.folders;
    counts_.files += counts.files;
    counts_.bytes += counts.bytes;
    return damaged;
  }
  return damaged;
}

std::string copy_private(const fs::path& from, const fs::path& to) {
  const fs::path part = fs::path(to) += ".part";
  Sha256 hash;
  {
    const File source = File::open(from);
    File copy = File::create(part);
    fs::permissions(part, fs::perms::owner_read | fs::perms::owner_write);
    each_piece(source, [&](const std::string& piece) {
      hash.add(piece);
      copy.append(piece);
    });
    copy.sync();
  }
  rename_unsynced(part, to);
  return hash.finish();
}

void sync_all(const fs::path& folder) {
  const File opened = File::open(folder);
  if (::syncfs(opened.descriptor()) == 0) return;
  throw Error(ErrorCode::storage_failed, folder.string() + " cannot be written to the disk (" +
                                             std::generic_category().message(errno) + ").");
}

}  // namespace unwrapd::server::backup
