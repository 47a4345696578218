#pragma once
// The only place that reads the time of day; all other code is given milliseconds. Durations are
// measured on a clock that cannot be set.

#include <cstdint>
#include <string>

namespace unwrapd::server {

inline constexpr std::int64_t kMsPerSecond = 1000;
inline constexpr std::int64_t kNsPerMs = 1'000'000;

/// Milliseconds since 1970-01-01 UTC.
std::int64_t now_ms();

/// Milliseconds since some moment before this process began.
std::int64_t elapsed_ms();

/// Readings of both clocks.
struct Times {
  std::int64_t of_day_ms = 0;
  std::int64_t elapsed_ms = 0;
  std::string boot = {};  ///< since when elapsed_ms counts: the same within one run of the kernel
};

/// Readings of one moment, to within a second.
Times read_clocks();

/// RFC 3339 in UTC with milliseconds: "2026-01-31T23:59:58.123Z".
std::string rfc3339(std::int64_t epoch_ms);

}  // namespace unwrapd::server
