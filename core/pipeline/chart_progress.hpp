#pragma once
// From what a solver tells of one chart to what a job tells of itself.

#include <optional>
#include <vector>

#include "core/base/executor.hpp"
#include "core/solve/solve.hpp"
#include "core/types/progress.hpp"

namespace unwrapd::pipeline {

/// The share of the job that lies behind us when charts are made, when solving begins, where charts
/// need not be sought first, and when it ends.
inline constexpr double kChartsBegin = 0.05, kSolveBegin = 0.10, kSolveEnd = 0.90;

/// Where the solving of charts stands: which chart, which lambda, how far. Charts weigh by their
/// faces, the lambdas of a chart weigh alike.
class ChartProgress {
 public:
  /// progress and executor, which runs what is measured of iterations, must outlive the watch.
  /// begin: the share of the job that is behind us.
  ChartProgress(const Progress& progress, Index chart_count, std::size_t face_count, double begin,
                Executor& executor);

  void begin_chart(std::size_t faces, std::size_t lambda_count);
  /// lambda is told with every event of the run; empty when there is but one map.
  void begin_run(std::optional<double> lambda);
  void end_run() { ++runs_done_; }
  void end_chart();

  void tell(Stage stage) const;
  /// What to hand to a Solver. disk and stop must outlive it, and told, to which each iteration
  /// that is told of is added.
  [[nodiscard]] solve::SolveWatch solve_watch(const solve::Disk& disk, const Stop& stop,
                                              std::vector<IterationEvent>& told) const;
  /// What was told of an equal run, as of this one.
  void tell_again(const std::vector<IterationEvent>& told, const Stop& stop) const;
  /// Whether iterations are told of at all.
  [[nodiscard]] bool is_followed() const { return progress_.on_iteration != nullptr; }
  void throw_if_cancelled() const;
  [[nodiscard]] const std::stop_token& stop() const { return progress_.stop; }

 private:
  [[nodiscard]] double fraction(double of_run) const;
  [[nodiscard]] IterationEvent placed(IterationEvent event, const Stop& stop) const;

  const Progress& progress_;
  Executor& executor_;
  Index chart_ = 0, chart_count_;
  double faces_total_, faces_done_ = 0, faces_now_ = 0;
  double begin_;
  double runs_ = 1, runs_done_ = 0;
  std::optional<double> lambda_;
};

}  // namespace unwrapd::pipeline
