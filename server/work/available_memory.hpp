#pragma once
// How much memory there is for jobs.

#include <cstddef>

namespace unwrapd::server::work {

/// Bytes of the machine, or of the container that this process runs in where that has less.
std::size_t memory_of_machine();

}  // namespace unwrapd::server::work
