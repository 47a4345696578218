#pragma once
// The clock for retention times and webhooks: the time of day as if it had never been set. It is
// stored beside the object that it belongs to and never changed again. By how much the time of day
// was set is noted in the store, for the next start (JobStore::note_time()).
//
// A start compares the clocks with those noted last. Within one boot of the machine, both tell how
// long no server ran. After another boot only the time of day does, which may be wrong until it is
// synchronised: it is believed up to an hour. A longer pause is taken for a clock that was set, so
// that nothing is removed because of it and files are kept that much longer.

#include <cstdint>
#include <cstdlib>
#include <functional>

#include "server/base/clock.hpp"

namespace unwrapd::server {

inline constexpr std::int64_t kSetByMs = 10'000;               ///< less is the clock's own drift
inline constexpr std::int64_t kLongestBelievedMs = 3'600'000;  ///< between two boots, if believed

/// A moment of the time of day.
struct Moment {
  std::int64_t of_day_ms = 0;
  std::int64_t set_by_ms = 0;  ///< by which the time of day was set before it

  [[nodiscard]] std::int64_t kept_ms() const { return of_day_ms - set_by_ms; }
};

/// What a server has noted of the clocks; of_day_ms 0: nothing.
struct NotedTime {
  Times times;
  std::int64_t set_by_ms = 0;
};

/// By how much the time of day was set by now, when a server starts.
inline std::int64_t set_by_at_start(const NotedTime& noted, const Times& now) {
  if (noted.times.of_day_ms == 0) return noted.set_by_ms;
  const std::int64_t passed_ms = now.of_day_ms - noted.times.of_day_ms;
  const std::int64_t elapsed_ms = now.elapsed_ms - noted.times.elapsed_ms;
  const bool same_boot = !now.boot.empty() && now.boot == noted.times.boot && elapsed_ms >= 0;
  if (same_boot) {
    const std::int64_t moved_ms = passed_ms - elapsed_ms;
    return noted.set_by_ms + (std::abs(moved_ms) < kSetByMs ? 0 : moved_ms);
  }
  const bool believed = passed_ms > -kSetByMs && passed_ms <= kLongestBelievedMs;
  return noted.set_by_ms + (believed ? 0 : passed_ms);
}

/// Thread-safe.
class RetentionClock {
 public:
  using Read = std::function<Times()>;

  RetentionClock(const Read& read, const NotedTime& noted) : RetentionClock(read, noted, read()) {}

  [[nodiscard]] Times clocks() const { return read_(); }
  [[nodiscard]] Moment now() const {
    const Times times = read_();
    const std::int64_t moved_ms = offset_of(times) - offset_ms_;
    return {times.of_day_ms, before_ms_ + (std::abs(moved_ms) < kSetByMs ? 0 : moved_ms)};
  }

 private:
  RetentionClock(Read read, const NotedTime& noted, const Times& at_first)
      : read_(std::move(read)),
        before_ms_(set_by_at_start(noted, at_first)),
        offset_ms_(offset_of(at_first)) {}

  static std::int64_t offset_of(const Times& times) { return times.of_day_ms - times.elapsed_ms; }

  const Read read_;
  const std::int64_t before_ms_;
  const std::int64_t offset_ms_;  // of the time of day over the elapsed, at first
};

}  // namespace unwrapd::server
