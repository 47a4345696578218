#include "tests/asset/memory_guard.hpp"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> held{0};
std::atomic<std::size_t> peak{0};

#if !defined(__SANITIZE_ADDRESS__)
void* counted(void* block) {
  if (block == nullptr) throw std::bad_alloc();
  const std::size_t now = held += malloc_usable_size(block);
  for (std::size_t seen = peak; now > seen && !peak.compare_exchange_weak(seen, now);) {
  }
  return block;
}

void release(void* block) {
  if (block != nullptr) held -= malloc_usable_size(block);
  std::free(block);
}
#endif

}  // namespace

#if !defined(__SANITIZE_ADDRESS__)
void* operator new(std::size_t size) { return counted(std::malloc(size)); }
void* operator new[](std::size_t size) { return counted(std::malloc(size)); }
void operator delete(void* block) noexcept { release(block); }
void operator delete[](void* block) noexcept { release(block); }
void operator delete(void* block, std::size_t) noexcept { release(block); }
void operator delete[](void* block, std::size_t) noexcept { release(block); }
#endif

namespace unwrapd::asset::test {

MemoryPeak::MemoryPeak() : start_(held) { peak = start_; }

std::size_t MemoryPeak::bytes() const { return peak - start_; }

}  // namespace unwrapd::asset::test
