#pragma once
// The folder of a job or mesh: the names of its files, their digests, and its removal.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include "server/blobs/digests.hpp"

namespace unwrapd::server::blobs {

inline constexpr std::string_view kDocumentFile = "document";
inline constexpr std::string_view kOptionsFile = "options.json";  ///< of long options alone
inline constexpr std::string_view kReportFile = "report.json";
inline constexpr std::string_view kTotalsFile = "totals.json";
inline constexpr std::string_view kUvFile = "uv.bin";

/// "result.glb", "result.gltf", "result.obj" or "result.json".
std::string result_file(std::string_view format);

/// "buffer_0": the file of an upload's k-th buffer.
std::string buffer_file(std::size_t k);

/// Whether a file is what the sender brought: it stays as it came.
bool is_input(std::string_view file);

/// Syncs the files that are chosen, and replaces their digests: by those that are known, or by
/// those of the bytes that are there. Digests have their name when all files are on the disk. The
/// folder is not synced.
void seal_files(const std::filesystem::path& folder,
                const std::function<bool(std::string_view)>& chosen, const Digests& known = {});

/// Once: version 0.1.0 noted no digests. Every later one begins a folder with some, so that one
/// which has lost them is told from one that never had any.
void note_first_version(const std::filesystem::path& blobs, const std::filesystem::path& done);

/// Removes folders. One that could not be removed (it cannot be opened while no descriptor is left)
/// is remembered and tried again. Thread-safe.
class LeftFolders {
 public:
  void remove(const std::filesystem::path& folder) noexcept;
  /// Tries again to remove the folders that are left. Returns their number before.
  int retry() noexcept;

 private:
  std::mutex mutex_;
  std::set<std::filesystem::path> folders_;
};

}  // namespace unwrapd::server::blobs
