#include "client/input_file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <string>

#include "client/failure.hpp"
#include "client/files.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

constexpr int kWaitMs = 100;  // until a stop is seen
constexpr std::size_t kReadBytes = 65536;

/// A descriptor to read from. Standard input is not opened again, since a socket cannot be.
class Source {
 public:
  explicit Source(const fs::path& path)
      : is_standard_(is_standard(path) || path == "/dev/stdin"),
        name_(is_standard_ ? "Standard input" : path.string()),
        descriptor_(is_standard_ ? STDIN_FILENO
                                 : ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    if (descriptor_ < 0) fail();
  }
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  ~Source() {
    if (!is_standard_) ::close(descriptor_);
  }

  [[nodiscard]] const std::string& name() const { return name_; }

  /// The number of bytes read, 0 at the end. Throws Failure{interrupted} once it is stopped.
  std::size_t read(std::array<char, kReadBytes>& block, const std::stop_token& stop) const {
    while (!stop.stop_requested()) {
      pollfd ready{descriptor_, POLLIN, 0};
      if (::poll(&ready, 1, kWaitMs) <= 0) continue;
      const ssize_t got = ::read(descriptor_, block.data(), block.size());
      if (got >= 0) return static_cast<std::size_t>(got);
      if (errno != EAGAIN && errno != EINTR) fail();
    }
    throw Failure(ExitCode::interrupted, "Stopped before the mesh was read.");
  }

 private:
  [[noreturn]] void fail() const { throw Failure(ExitCode::file, name_ + " cannot be read."); }

  bool is_standard_;
  std::string name_;
  int descriptor_;
};

void copy(const Source& source, const fs::path& to, const std::stop_token& stop) {
  std::ofstream stream(to, std::ios::binary);
  std::array<char, kReadBytes> block{};
  while (const std::size_t count = source.read(block, stop))
    stream.write(block.data(), static_cast<std::streamsize>(count));
  const bool is_empty = stream.tellp() == 0;
  stream.close();
  if (!stream)
    throw Failure(ExitCode::file, to.string() +
                                      " cannot be written; set TMPDIR to a folder with "
                                      "more free space.");
  if (is_empty) throw Failure(ExitCode::file, source.name() + " is empty; write a mesh into it.");
}

}  // namespace

TemporaryFile::TemporaryFile() {
  std::error_code error;
  std::string name = (fs::temp_directory_path(error) / "unwrap.XXXXXX").string();
  const int descriptor = error ? -1 : ::mkstemp(name.data());
  if (descriptor < 0)
    throw Failure(ExitCode::file,
                  "A temporary file cannot be made; set TMPDIR to a folder that can be written.");
  ::close(descriptor);
  path_ = name;
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  fs::remove(path_, ignored);
}

InputFile::InputFile(const fs::path& path, const std::stop_token& stop) : path_(path) {
  if (!is_stream(path)) {
    file_bytes(path);
    return;
  }
  const Source source(path);
  copy_.emplace();
  copy(source, copy_->path(), stop);
}

}  // namespace unwrapd::client
