#pragma once
// Memory for many numbers, in pages of 2 MB if the system has them. Every solve reads panels from
// end to end; with pages of 4 KB, a tenth of a first job was spent on page faults and a fifth of a
// solve on address translation. On other systems the advice has no effect.

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

namespace unwrapd::linear {

struct FreeNumbers {
  void operator()(double* numbers) const { std::free(numbers); }
};
inline constexpr std::size_t kHugePage = std::size_t{2} << 20, kCacheLine = 64;  // bytes
inline constexpr std::size_t kWorthHugePages = 2 * kHugePage;

using LargeArray = std::unique_ptr<double[], FreeNumbers>;

/// `count` uninitialized numbers. Throws std::bad_alloc.
inline LargeArray large_array(std::size_t count) {
  const std::size_t bytes = sizeof(double) * count;
  const std::size_t page = bytes >= kWorthHugePages ? kHugePage : kCacheLine;
  const std::size_t whole_pages = (bytes / page + 1) * page;
  auto* numbers = static_cast<double*>(std::aligned_alloc(page, whole_pages));
  if (numbers == nullptr) throw std::bad_alloc();
  if (page == kHugePage) madvise(numbers, bytes / page * page, MADV_HUGEPAGE);
  return LargeArray(numbers);
}

}  // namespace unwrapd::linear
