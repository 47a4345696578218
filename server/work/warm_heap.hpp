#pragma once
// The pages of a heap, taken from the kernel before they are needed: it clears each that a process
// takes, and finds some of them slowly.

#include <cstdint>

namespace unwrapd::server::work {

/// Has the heap of the calling process grow by so many bytes, for allocations to come; gives up
/// early when something can be read from the descriptor, or when there is no memory.
void warm_heap(std::int64_t bytes, int until_readable);

/// What warm_heap() should take for a job to come: what the largest process that this one has
/// started and waited for took, no more than one of 20,000 faces does.
[[nodiscard]] std::int64_t heap_of_largest_child();

}  // namespace unwrapd::server::work
