#pragma once
// Tests are compiled once and linked with the libraries of each build: what differs under a
// sanitizer is decided when they run.

extern "C" {
[[gnu::weak]] void __asan_init();  // NOLINT: the sanitizers give the names
[[gnu::weak]] void __tsan_init();  // NOLINT
}

namespace unwrapd {

/// Whether a sanitizer watches the libraries under test.
inline bool is_sanitized() { return __asan_init != nullptr || __tsan_init != nullptr; }

}  // namespace unwrapd
