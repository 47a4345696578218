#pragma once
// Work that is counted, not timed: code compiled with -fsanitize-coverage=trace-pc calls a function
// in each basic block, and here it counts.

#include <cstdint>

namespace unwrapd::asset::test {

/// Basic blocks that this program has run so far.
std::uint64_t block_count();

}  // namespace unwrapd::asset::test
