#pragma once
// Files as the store needs them: whole or absent. What is written here is on the disk (fsync)
// before it has its name (rename), so that a crash at any point leaves no partial file under it.
// Every failure is Error{storage_failed}, or Error{storage_full} when there is no room to write.

#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server {

/// What Error{storage_full} says.
inline constexpr std::string_view kStorageFull =
    "The server's disk is full; try again later, or remove jobs that are no longer needed.";

/// By which a file is known, and whether it has been written since.
struct FileStamp {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t size = 0;
  std::int64_t changed_ns = 0;  ///< when its bytes were written last, since 1970

  auto operator<=>(const FileStamp&) const = default;
};

/// An open file descriptor.
class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  File(File&& other) noexcept;
  File& operator=(File&&) = delete;
  ~File();

  /// Creates a file that must not exist yet, for writing.
  static File create(const std::filesystem::path& path);
  static File open(const std::filesystem::path& path);

  void append(std::string_view bytes);
  /// On return the content survives a loss of power.
  void sync();
  /// Has the disk begin with what a later sync() waits for.
  void begin_sync() noexcept;
  [[nodiscard]] std::int64_t size() const;
  [[nodiscard]] FileStamp stamp() const;
  /// Reads at most length bytes from offset; fewer only at the end of the file.
  [[nodiscard]] std::string read(std::int64_t offset, std::size_t length) const;
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

std::string read_file(const std::filesystem::path& path);

/// Replaces path by a file with these bytes; readers see the old one or the new one.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// The same, but its name need not survive a loss of power before sync_directory() of its
/// directory. before_naming: done when the bytes are on the disk and have no name yet.
void write_file_unlisted(const std::filesystem::path& path, std::string_view bytes,
                         const std::function<void()>& before_naming);

/// The same, but what is written need not survive a loss of power before sync_file(path) and
/// sync_directory() of its directory, so that several files wait for the disk but once.
void write_file_unsynced(const std::filesystem::path& path, std::string_view bytes);

void sync_file(const std::filesystem::path& path);

/// Files and directories that are being synced while the caller goes on: what waits for the disk at
/// the same time waits but once.
class Syncs {
 public:
  explicit Syncs(const std::vector<std::filesystem::path>& files);
  /// On return all of them survive a loss of power. Throws as sync_file() does.
  void finish();

 private:
  std::vector<std::future<void>> shares_;
};

/// Whether path is what write_file() leaves behind when the machine stops in the middle of it.
bool is_unfinished(const std::filesystem::path& path);

/// Makes the names in a directory survive a loss of power.
void sync_directory(const std::filesystem::path& directory);

/// Whether text names something in a folder, and nothing outside of it.
bool is_file_name(std::string_view text);

/// Renames; no directory is synced.
void rename_unsynced(const std::filesystem::path& from, const std::filesystem::path& to);

void make_directories(const std::filesystem::path& directory);

/// Removes a file or a whole directory; silent when it is not there.
void remove_tree(const std::filesystem::path& path) noexcept;

}  // namespace unwrapd::server
