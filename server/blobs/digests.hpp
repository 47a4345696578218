#pragma once
// The SHA-256 of every file of a job, in the file `digests` beside them, in the form of sha256sum:
// `cd DIR/blobs/<job> && sha256sum -c digests` checks a job by hand. A file system that returns
// other bytes than were written is thereby noticed before they are worked on or handed out.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "server/base/files.hpp"

namespace unwrapd::server::blobs {

inline constexpr std::string_view kDigestsFile = "digests";

/// From a file's name to the SHA-256 of its bytes, lowercase hex.
using Digests = std::map<std::string, std::string, std::less<>>;

/// Of a job's folder; empty when nothing has been noted there. Lines of another form are passed
/// over: their files then count as not noted.
Digests read_digests(const std::filesystem::path& folder);
/// As they are written.
std::string to_text(const Digests& digests);
/// All but the folder is synced; before_naming: as of write_file_unlisted().
void write_digests(
    const std::filesystem::path& folder, const Digests& digests,
    const std::function<void()>& before_naming = [] {});

/// SHA-256 of a file, read in pieces.
std::string sha256_of(const File& file);

}  // namespace unwrapd::server::blobs
