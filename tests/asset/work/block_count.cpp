#include "tests/asset/work/block_count.hpp"

#include <atomic>

namespace {
std::atomic<std::uint64_t> blocks = 0;
}

extern "C" void __sanitizer_cov_trace_pc() {  // NOLINT: its name
  blocks.store(blocks.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

namespace unwrapd::asset::test {

std::uint64_t block_count() { return blocks.load(std::memory_order_relaxed); }

}  // namespace unwrapd::asset::test
