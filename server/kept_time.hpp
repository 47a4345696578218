#pragma once
// The time by which it is told how long something is kept, or when a webhook is called: the time of
// day as if nobody had set it. It is written beside what it is of, and never changed again; by how
// much the time of day was set is noted in the store, for the next start (JobStore::note_time()).

#include <cstdint>
#include <cstdlib>
#include <functional>

#include "server/clock.hpp"

namespace unwrapd::server {

inline constexpr std::int64_t kSetByMs = 10'000;  ///< less is the clock's own drift

/// A moment of the time of day.
struct Moment {
  std::int64_t of_day_ms = 0;
  std::int64_t set_by_ms = 0;  ///< by which the time of day was set before it

  [[nodiscard]] std::int64_t kept_ms() const { return of_day_ms - set_by_ms; }
};

/// Thread-safe.
class KeptTime {
 public:
  using Read = std::function<Times()>;

  /// before_ms: by which the time of day was set before this process.
  KeptTime(Read read, std::int64_t before_ms)
      : read_(std::move(read)), before_ms_(before_ms), offset_ms_(offset_of(read_())) {}

  [[nodiscard]] Moment now() const {
    const Times times = read_();
    const std::int64_t moved_ms = offset_of(times) - offset_ms_;
    return {times.of_day_ms, before_ms_ + (std::abs(moved_ms) < kSetByMs ? 0 : moved_ms)};
  }

 private:
  static std::int64_t offset_of(const Times& times) { return times.of_day_ms - times.elapsed_ms; }

  const Read read_;
  const std::int64_t before_ms_;
  const std::int64_t offset_ms_;  // of the time of day over the elapsed, at first
};

}  // namespace unwrapd::server
