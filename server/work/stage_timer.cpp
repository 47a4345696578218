#include "server/work/stage_timer.hpp"

#include "api/job.hpp"

namespace unwrapd::server::work {
namespace {

double ms(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

}  // namespace

void StageTimer::enter(Stage stage) {
  const TimePoint now = std::chrono::steady_clock::now();
  spent_ms_[static_cast<std::size_t>(stage_)] += ms(now - since_);
  since_ = now;
  stage_ = stage;
}

double StageTimer::elapsed_ms() const { return ms(std::chrono::steady_clock::now() - began_); }

std::map<std::string, double> StageTimer::timings_ms(double queue_ms) {
  enter(stage_);
  std::map<std::string, double> timings = {{"queue", queue_ms}};
  double total = queue_ms;
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    timings[std::string(api::stage_name(static_cast<Stage>(stage)))] = spent_ms_[stage];
    total += spent_ms_[stage];
  }
  timings["total"] = total;
  return timings;
}

}  // namespace unwrapd::server::work
