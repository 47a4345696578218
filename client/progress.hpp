#pragma once
// The progress of a job on one line of the terminal.

#include <chrono>
#include <iosfwd>
#include <optional>
#include <set>
#include <string>

#include "api/json.hpp"

namespace unwrapd::client {

/// The latest figures. chart counts from 0; charts is 0 while their number is unknown.
struct ProgressState {
  std::string stage = "upload";
  double fraction = 0;           ///< of the whole job, [0, 1]
  std::optional<double> lambda;  ///< the present one of several
  int chart = 0;
  int charts = 0;
  int iteration = 0;  ///< 0 before the first iteration
  double energy = 0;
  double angle = 2;  ///< D_angle
  double area = 2;   ///< D_area
  int flipped = 0;
};

/// The state after an event of the job's stream (api/events.hpp). Members that are missing in the
/// event, or of another type, keep their values.
ProgressState advance(ProgressState state, const std::string& event, const api::Json& data);

/// "solve chart 2/3 [====>     ]  52% iteration 7 E 0.0469 D_angle 2.061 D_area 2.057 flips 1", in
/// ASCII and at most width characters. If space is short the bar shrinks, then disappears, then the
/// line is cut.
std::string progress_line(const ProgressState& state, std::size_t width);

/// How progress is shown: a bar that is redrawn in place, plain lines, or not at all.
enum class ProgressStyle { none, lines, bar };

/// Draws on out: a bar at most 20 times a second; or lines, when a kind of stage first begins
/// (after the last figures of the one before), and once a second in between.
class ProgressView {
 public:
  using Clock = std::chrono::steady_clock;

  ProgressView(std::ostream& out, ProgressStyle style, std::size_t width);

  ProgressView(const ProgressView&) = delete;
  ProgressView& operator=(const ProgressView&) = delete;
  ~ProgressView();  ///< removes the bar; lines stay

  void show(const ProgressState& state, Clock::time_point now);

 private:
  [[nodiscard]] bool is_due(Clock::duration interval, Clock::time_point now) const;
  void draw_bar(const ProgressState& state, Clock::time_point now);
  void write_line(const ProgressState& state, Clock::time_point now);

  std::ostream& out_;
  ProgressStyle style_;
  std::size_t width_;
  std::optional<Clock::time_point> drawn_;
  std::set<std::string> stages_;          ///< that have begun
  std::optional<ProgressState> pending_;  ///< figures that are not on a line yet
};

}  // namespace unwrapd::client
