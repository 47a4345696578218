#pragma once
// What jobs share. Core keeps nothing from one job to the next: before it makes what is costly and
// depends on a mesh alone, it asks a SolverCore that it is handed, as it is handed an Executor.

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string_view>
#include <vector>

namespace unwrapd {

/// Stands for the bytes that it was made from.
using Digest = std::array<std::byte, 32>;

/// What a thing depends on: what kind of thing it is, and views of all bytes that it is made from.
class Content {
 public:
  explicit Content(std::string_view kind) { add(kind); }

  /// Values (a vector, an array, a span) whose bytes are all that they are, and which live until
  /// the digest is taken.
  template <typename Values>
  Content& add(const Values& values) {
    parts_.push_back(std::as_bytes(std::span(values)));
    return *this;
  }

  [[nodiscard]] const std::vector<std::span<const std::byte>>& parts() const { return parts_; }

 private:
  std::vector<std::span<const std::byte>> parts_;
};

class SolverCore {
 public:
  struct Made {
    std::shared_ptr<const void> value;
    std::size_t bytes;  ///< that keeping it takes
  };

  SolverCore() = default;
  SolverCore(const SolverCore&) = delete;
  SolverCore& operator=(const SolverCore&) = delete;
  virtual ~SolverCore() = default;

  /// Other digests for other contents, lengths of the parts included.
  [[nodiscard]] virtual Digest digest(const Content& content) const = 0;

  /// What was made under this key before, or what make() gives. Jobs that ask for the same key at
  /// once get the same value, made once; where make() throws, so does this, and the next one makes
  /// it anew. Thread-safe. make() must not ask for the same key. Throws Error{cancelled} where a
  /// stop is requested while another job makes it.
  virtual std::shared_ptr<const void> obtain(const Digest& key, const std::function<Made()>& make,
                                             const std::stop_token& stop) = 0;

  /// Bytes that one job may take.
  [[nodiscard]] virtual std::size_t memory_limit() const = 0;
};

/// That a job takes for a face beside the factor: positions, rest triangles, maps, what was read
/// and what is written (measured: 600 to 800 at 100k to 1M faces).
inline constexpr std::size_t kJobBytesPerFace = 800;

/// Throws Error{too_much_memory}, with the estimate, when a job would take so many bytes and may
/// take less.
void check_memory(std::size_t bytes, std::size_t limit);

}  // namespace unwrapd
