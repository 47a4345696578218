#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace unwrapd::server::jobs {

/// How long no job is begun once one has found the disk full: twice as long for each further one in
/// a row, up to a minute. Not for use by two threads at once.
class DiskFullBackoff {
 public:
  using Clock = std::chrono::steady_clock;

  /// A job has ended, and found the disk full or not.
  void note(bool full) {
    full_in_a_row_ = full ? full_in_a_row_ + 1 : 0;
    if (!full) return;
    const std::chrono::seconds pause(std::int64_t{1} << std::min(full_in_a_row_ - 1, kMostDoubled));
    until_ = Clock::now() + std::min(pause, kLongest);
  }
  /// Whether the last job to end found it full.
  [[nodiscard]] bool is_full() const { return full_in_a_row_ > 0; }
  [[nodiscard]] Clock::time_point until() const { return until_; }
  /// Until then, rounded up; 0 when it is over.
  [[nodiscard]] int seconds_left() const {
    const auto left = std::chrono::ceil<std::chrono::seconds>(until_ - Clock::now());
    return std::max(0, static_cast<int>(left.count()));
  }

 private:
  static constexpr int kMostDoubled = 6;
  static constexpr std::chrono::seconds kLongest{60};

  Clock::time_point until_{};
  int full_in_a_row_ = 0;
};

}  // namespace unwrapd::server::jobs
