#pragma once
// Copies of a data directory, and what is wrong with one. A backup is a data directory of its own:
// jobs.sqlite and keys.sqlite as of one moment, `secret`, blobs/, and backup.json, which is written
// last and has the SHA-256 of the others. It can be made while a server works: the rows are of the
// moment at which it began, and what ended or went since then is left out of it. Files that share
// their bytes share them there, too. Links into the data directory itself were rejected: damage to
// its disk would be in the backup as well.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace unwrapd::server::backup {

inline constexpr const char* kManifestFile = "backup.json";

/// What was copied or looked at, and what was found.
struct StoreReport {
  std::int64_t jobs = 0;  ///< and meshes, that have files
  std::int64_t files = 0;
  std::int64_t bytes = 0;
  std::vector<std::string> damaged = {};  ///< "j_12/document is missing"
  std::vector<std::string> notices = {};  ///< what is no damage, and worth a line
};

/// Copies a data directory to a folder that is not there yet. Files that are damaged are left out
/// and told. Throws Error: invalid_option for a folder that is there, not_found where there is no
/// store, storage_failed, storage_full; there is no backup then.
StoreReport back_up(const std::filesystem::path& data, const std::filesystem::path& to);

/// Makes a data directory, which must be empty or missing, of a backup. Everything is checked
/// first. Throws Error: storage_corrupt for a backup that is not whole, invalid_option for a
/// directory in use, and like back_up().
StoreReport restore(const std::filesystem::path& backup, const std::filesystem::path& data);

/// Reads all of a data directory, also while a server works on it, or of a backup. Throws Error:
/// not_found, storage_failed.
StoreReport check_store(const std::filesystem::path& data);

}  // namespace unwrapd::server::backup
