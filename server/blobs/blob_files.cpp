#include "server/blobs/blob_files.hpp"

#include <system_error>
#include <vector>

#include "server/base/files.hpp"

namespace unwrapd::server::blobs {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBufferPrefix = "buffer_";

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

}  // namespace

std::string result_file(std::string_view format) { return "result." + std::string(format); }

std::string buffer_file(std::size_t k) { return std::string(kBufferPrefix) + std::to_string(k); }

bool is_input(std::string_view file) {
  return file == kDocumentFile || file == kOptionsFile || file.starts_with(kBufferPrefix);
}

void seal_files(const fs::path& folder, const std::function<bool(std::string_view)>& chosen,
                const Digests& known) {
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

void LeftFolders::remove(const std::filesystem::path& folder) noexcept {
  std::error_code failed;
  std::filesystem::remove_all(folder, failed);
  if (!failed) return;
  const std::lock_guard lock(mutex_);
  folders_.insert(folder);
}

int LeftFolders::retry() noexcept {
  std::set<std::filesystem::path> left;
  {
    const std::lock_guard lock(mutex_);
    left.swap(folders_);
  }
  for (const std::filesystem::path& folder : left) remove(folder);
  return static_cast<int>(left.size());
}

}  // namespace unwrapd::server::blobs
