#pragma once
// Counts what the program holds on its heap, so that a test can bound it. Under AddressSanitizer,
// which has its own allocator, nothing is counted and peaks are 0.

#include <cstddef>

namespace unwrapd::asset::test {

/// The most bytes that were held at a time since this began, beyond those held then.
class MemoryPeak {
 public:
  MemoryPeak();
  [[nodiscard]] std::size_t bytes() const;

 private:
  std::size_t start_;
};

}  // namespace unwrapd::asset::test
