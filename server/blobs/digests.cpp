#include "server/blobs/digests.hpp"

#include <sstream>

#include "server/base/identity.hpp"

namespace unwrapd::server::blobs {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{256} * 1024;
constexpr std::size_t kDigestLength = 64;
constexpr std::string_view kSeparator = "  ";

}  // namespace

Digests read_digests(const std::filesystem::path& folder) {
  Digests digests;
  const std::filesystem::path path = folder / kDigestsFile;
  if (!std::filesystem::exists(path)) return digests;
  std::istringstream lines(read_file(path));
  for (std::string line; std::getline(lines, line);) {
    const bool well_formed = line.size() > kDigestLength + kSeparator.size() &&
                             line.compare(kDigestLength, kSeparator.size(), kSeparator) == 0;
    if (!well_formed) continue;
    digests[line.substr(kDigestLength + kSeparator.size())] = line.substr(0, kDigestLength);
  }
  return digests;
}

std::string to_text(const Digests& digests) {
  std::string text;
  for (const auto& [file, digest] : digests) text += digest + std::string(kSeparator) + file + "\n";
  return text;
}

void write_digests(const std::filesystem::path& folder, const Digests& digests,
                   const std::function<void()>& before_naming) {
  write_file_unlisted(folder / kDigestsFile, to_text(digests), before_naming);
}

std::string sha256_of(const File& file) {
  Sha256 hash;
  for (std::int64_t offset = 0;;) {
    const std::string piece = file.read(offset, kPieceBytes);
    if (piece.empty()) return hash.finish();
    hash.add(piece);
    offset += static_cast<std::int64_t>(piece.size());
  }
}

}  // namespace unwrapd::server::blobs
