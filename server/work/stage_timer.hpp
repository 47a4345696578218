#pragma once
// Where the time of a job goes. Core tells stages; the clock is read here and nowhere in core.

#include <array>
#include <chrono>
#include <map>
#include <string>

#include "core/types/progress.hpp"

namespace unwrapd::server::work {

class StageTimer {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// began: when the worker took the job; its first stage is read.
  explicit StageTimer(TimePoint began) : began_(began), since_(began) {}

  /// The current stage ends and this one begins.
  void enter(Stage stage);
  /// Milliseconds since the job began.
  [[nodiscard]] double elapsed_ms() const;
  /// Every stage, the queue (as told), and their total.
  std::map<std::string, double> timings_ms(double queue_ms);

 private:
  static constexpr std::size_t kStageCount = static_cast<std::size_t>(Stage::write) + 1;

  const TimePoint began_;
  TimePoint since_;
  Stage stage_ = Stage::read;
  std::array<double, kStageCount> spent_ms_{};
};

}  // namespace unwrapd::server::work
