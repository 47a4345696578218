#pragma once
// Turns the progress of a solver on one chart into the progress of the job.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"
#include "core/solve/solve.hpp"
#include "core/types/progress.hpp"

namespace unwrapd::pipeline {

/// Shares of the job that are done when the charts are made, when solving begins if no surface is
/// segmented, and when solving ends.
inline constexpr double kChartsBegin = 0.05, kSolveBegin = 0.10, kSolveEnd = 0.90;

/// What is told of a chart, without its place in the job.
struct ChartEvent {
  enum class Kind : std::uint8_t { begin_run, stage, iteration, end_run };
  Kind kind = Kind::stage;
  std::optional<double> lambda = {};  ///< of a run that begins
  Stage stage = Stage::setup;
  IterationEvent iteration = {};
};

/// The progress of solving: which chart, which lambda, how far. Charts count by their faces, the
/// lambdas of a chart count alike.
class ChartProgress {
 public:
  /// executor: measures the map of each iteration. progress and executor must outlive this. begin:
  /// the share of the job that is done.
  ChartProgress(const Progress& progress, std::span<const charts::Charts> surfaces, double begin,
                Executor& executor);

  void begin_chart(std::size_t faces, std::size_t lambda_count);
  /// lambda: reported with every event of the run; empty when there is one map only.
  void begin_run(std::optional<double> lambda);
  void end_run();
  void end_chart();
  /// What is told of the next charts is added to events, too; null: no longer.
  void record_to(std::vector<ChartEvent>* events) { record_ = events; }
  /// Tells what was recorded of the chart that has begun.
  void tell_again(const std::vector<ChartEvent>& events, const Stop& stop);

  void tell(Stage stage) const;
  /// The watch for a Solver, which reports every iteration and appends it to events. disk, stop and
  /// events must outlive it.
  [[nodiscard]] solve::SolveWatch solve_watch(const solve::Disk& disk, const Stop& stop,
                                              std::vector<IterationEvent>& events) const;
  /// Reports the events of an identical run as events of this one.
  void replay(const std::vector<IterationEvent>& events, const Stop& stop) const;
  /// Whether iterations are reported at all.
  [[nodiscard]] bool is_followed() const { return progress_.on_iteration != nullptr; }
  void throw_if_cancelled() const;
  [[nodiscard]] const std::stop_token& stop() const { return progress_.stop; }

 private:
  [[nodiscard]] double fraction(double of_run) const;
  [[nodiscard]] IterationEvent placed(IterationEvent event, const Stop& stop) const;
  void tell(const IterationEvent& event, const Stop& stop) const;
  void record(const ChartEvent& event) const;

  const Progress& progress_;
  Executor& executor_;
  Index chart_ = 0, chart_count_ = 0;
  double faces_total_ = 1, faces_done_ = 0, faces_now_ = 0;
  double begin_;
  double runs_ = 1, runs_done_ = 0;
  std::optional<double> lambda_;
  std::vector<ChartEvent>* record_ = nullptr;
};

}  // namespace unwrapd::pipeline
