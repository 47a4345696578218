#pragma once
// A process that locks itself in before it touches a stranger's bytes: no file, no network, no
// other program, bounded memory and processor time. Linux: resource limits, no_new_privs, a seccomp
// filter that knows what a computing process needs and ends the process for anything else.

#include <cstdint>

namespace unwrapd::server {

struct SandboxLimits {
  std::int64_t memory_bytes = 0;  ///< of address space
  int processor_seconds = 0;
};

/// The calling process keeps descriptors 0, 1 and 2 and dies with the thread that started it.
/// Call before there are threads. Throws Error{internal} when the kernel cannot do it: nothing may
/// be decoded then.
void enter_sandbox(const SandboxLimits& limits);

}  // namespace unwrapd::server
