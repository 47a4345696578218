#include "core/pipeline/chart_progress.hpp"

#include <algorithm>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/measure/distortion.hpp"

namespace unwrapd::pipeline {
namespace {

/// The length of an accelerated run is unknown. So many iterations count as half of it, as many
/// again as half of the rest, and so on.
constexpr double kHalfWay = 20;

double share_done(int iterations, const Stop& stop) {
  if (stop.iterations) return std::min(1.0, static_cast<double>(iterations) / *stop.iterations);
  return 1 - std::exp2(-iterations / kHalfWay);
}

IterationEvent describe(const solve::Disk& disk, const solve::Solution& s, Executor& executor) {
  const Distortion d =
      measure::distortion(measure::distortion_sums(disk.rest, disk.faces, s.uv, executor));
  const double before = s.energy[s.energy.size() - 2], now = s.energy.back();
  return {.iteration = s.iterations,
          .energy = now,
          .rel_change = before > 0 ? (before - now) / before : 0,
          .angle = d.angle,
          .area = d.area,
          .flipped = d.flipped};
}

}  // namespace

ChartProgress::ChartProgress(const Progress& progress, std::span<const charts::Charts> surfaces,
                             double begin, Executor& executor)
    : progress_(progress), executor_(executor), begin_(begin) {
  std::size_t faces = 0;
  for (const charts::Charts& surface : surfaces) {
    chart_count_ += static_cast<Index>(surface.charts.size());
    for (const charts::Chart& chart : surface.charts) faces += chart.mesh.faces.size();
  }
  faces_total_ = static_cast<double>(std::max<std::size_t>(faces, 1));
}

void ChartProgress::begin_chart(std::size_t faces, std::size_t lambda_count) {
  faces_now_ = static_cast<double>(faces);
  runs_ = static_cast<double>(lambda_count);
  runs_done_ = 0;
}

void ChartProgress::begin_run(std::optional<double> lambda) {
  throw_if_cancelled();
  lambda_ = lambda;
  record({.kind = ChartEvent::Kind::begin_run, .lambda = lambda});
}

void ChartProgress::end_run() {
  ++runs_done_;
  record({.kind = ChartEvent::Kind::end_run});
}

void ChartProgress::end_chart() {
  ++chart_;
  faces_done_ += std::exchange(faces_now_, 0);
  runs_done_ = 0;
}

double ChartProgress::fraction(double of_run) const {
  const double of_chart = (runs_done_ + of_run) / runs_;
  const double done = (faces_done_ + of_chart * faces_now_) / faces_total_;
  return begin_ + (kSolveEnd - begin_) * done;
}

void ChartProgress::record(const ChartEvent& event) const {
  if (record_ != nullptr) record_->push_back(event);
}

void ChartProgress::tell_again(const std::vector<ChartEvent>& events, const Stop& stop) {
  for (const ChartEvent& event : events) {
    if (event.kind == ChartEvent::Kind::begin_run) begin_run(event.lambda);
    if (event.kind == ChartEvent::Kind::stage) tell(event.stage);
    if (event.kind == ChartEvent::Kind::iteration && is_followed()) tell(event.iteration, stop);
    if (event.kind == ChartEvent::Kind::end_run) end_run();
  }
}

void ChartProgress::tell(Stage stage) const {
  record({.kind = ChartEvent::Kind::stage, .stage = stage});
  if (!progress_.on_stage) return;
  const double of_run = stage == Stage::untangle ? 1 : 0;
  progress_.on_stage({stage, chart_, chart_count_, fraction(of_run), lambda_});
}

/// The event with its chart, its lambda and its place in the job.
IterationEvent ChartProgress::placed(IterationEvent event, const Stop& stop) const {
  event.chart = chart_;
  event.fraction = fraction(share_done(event.iteration, stop));
  event.lambda = lambda_;
  return event;
}

void ChartProgress::tell(const IterationEvent& event, const Stop& stop) const {
  record({.kind = ChartEvent::Kind::iteration, .iteration = event});
  progress_.on_iteration(placed(event, stop));
}

solve::SolveWatch ChartProgress::solve_watch(const solve::Disk& disk, const Stop& stop,
                                             std::vector<IterationEvent>& events) const {
  solve::SolveWatch watch;
  watch.loop.stop = progress_.stop;
  watch.on_stage = [this](Stage stage) { tell(stage); };
  if (is_followed())
    watch.loop.on_iteration = [this, &disk, &stop, &events](const solve::Solution& s) {
      events.push_back(describe(disk, s, executor_));
      tell(events.back(), stop);
    };
  return watch;
}

void ChartProgress::replay(const std::vector<IterationEvent>& events, const Stop& stop) const {
  tell(Stage::solve);
  for (const IterationEvent& event : events) tell(event, stop);
}

void ChartProgress::throw_if_cancelled() const { unwrapd::throw_if_cancelled(progress_.stop); }

}  // namespace unwrapd::pipeline
