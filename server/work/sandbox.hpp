#pragma once
// A process that locks itself in before it touches a stranger's bytes: no file, no network, no
// other program, no further thread, no signal to others, bounded memory and processor time. Linux:
// resource limits, no_new_privs, a seccomp filter that knows what a computing process needs and
// ends the process for anything else.

#include <cstdint>

namespace unwrapd::server::work {

struct SandboxLimits {
  std::int64_t memory_bytes = 0;  ///< of address space
  int processor_seconds = 0;
  int threads = 1;              ///< that the process starts before it enters, the first one counted
  std::int64_t warm_bytes = 0;  ///< of heap that it takes while it waits (warm_heap.hpp)
};

/// The calling process keeps descriptors 0, 1 and 2 and dies with the thread that started it.
/// Call from the first thread. All threads that there are enter with it; none can be started then.
/// Throws Error{internal} when the kernel cannot do it: nothing may be decoded then.
void enter_sandbox(const SandboxLimits& limits);

/// When memory runs out, the kernel ends this process before any that has not asked for it. Call
/// before enter_sandbox(). Without effect where /proc is missing.
void be_first_to_go();

}  // namespace unwrapd::server::work
