// Each lambda is solved on its own. Its minimum may have more distortion both of angles and of
// areas than that of another lambda: the energy counts a triangle that nearly collapses for little,
// D for much; and neighbours may end in different local minima. Where the maps are out of order,
// short descents from the maps of neighbours give others of nearly the same energy. Of all maps
// each lambda gets one, so that the order holds at the least energy (ADR 0060).
#include "core/pipeline/map_chart.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/guarantee/keep_guarantee.hpp"
#include "core/measure/distortion.hpp"
#include "core/pipeline/lambda_order.hpp"
#include "core/pipeline/settle_parts.hpp"
#include "core/solve/constrain_chart.hpp"
#include "core/solve/hybrid_energy.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr double kChartSlack = 9e-4;  // less than a list may have: rounding follows
constexpr double kNothing = 1e-12;    // energies below count as equal
constexpr double kLeastCost = 1e-6;   // a lambda's own map is preferred to equal ones
/// Enough for nearly all of the energy, and too few for triangles to collapse.
constexpr int kShortDescent = 8;

/// A solved map, kept by the guarantee.
struct Found {
  solve::Solution solution;
  std::vector<MappedChart> parts = {};
};

/// Solves a chart for any lambda.
class ChartSolver {
 public:
  ChartSolver(const ChartJob& job, const solve::Disk& disk, const UnwrapOptions& options,
              ChartProgress& progress, Executor& executor)
      : job_(job),
        disk_(disk),
        options_(options),
        progress_(progress),
        executor_(executor),
        constraints_(solve::constrain_chart(disk, options, job.page, disk.stop, executor)),
        solver_(disk, options,
                constrained_start(*job.chart, disk, options, constraints_.constrained), executor) {}

  Found run(double lambda) {
    progress_.begin_run(is_curve(options_) ? std::optional(lambda) : std::nullopt);
    Found found{parameterize_chart(solver_, job_, options_, lambda, progress_)};
    if (options_.guarantee != Guarantee::none) progress_.tell(Stage::untangle);
    keep_guarantee(found, lambda);
    progress_.end_run();
    return found;
  }

  Found run_from(const UvMap& start, double lambda, int max_iterations) {
    Found found{solver_.run_from(start, lambda, max_iterations)};
    keep_guarantee(found, lambda);
    return found;
  }

 private:
  void keep_guarantee(Found& found, double lambda) {
    const solve::VertexConstraints& held = constraints_.constrained.constraints;
    guarantee::GuaranteeRules rules = guarantee::rules_for(*job_.chart, disk_, options_, lambda);
    rules.intent.constrained = solve::fixed_vertices(disk_.positions.size(), held);
    rules.intent.soft = held.soft;
    rules.intent.executor = &executor_;
    rules.intent.global = solver_.global();
    guarantee::GuaranteedMap kept =
        guarantee::keep_guarantee(job_.chart, disk_, found.solution.uv, rules);
    found.parts = scale_parts(disk_, std::move(kept), constraints_, found.solution, executor_);
    settle_parts(options_, lambda, disk_.stop, executor_, found.parts);
  }

  const ChartJob& job_;
  const solve::Disk& disk_;
  const UnwrapOptions& options_;
  ChartProgress& progress_;
  Executor& executor_;
  const solve::ChartConstraints constraints_;
  solve::Solver solver_;
};

/// The maps of ascending lambdas, with what they cost each other.
class MapsInOrder {
 public:
  MapsInOrder(ChartSolver& solver, std::vector<double> lambdas, std::vector<Found> own,
              const UnwrapOptions& options, Executor& executor)
      : solver_(solver),
        lambdas_(std::move(lambdas)),
        found_(std::move(own)),
        options_(options),
        executor_(executor) {
    for (std::size_t k = 0; k < found_.size(); ++k) tradeoffs_.push_back(tradeoff_of(found_[k], k));
  }

  /// The maps of each lambda.
  std::vector<std::vector<MappedChart>> choose() && {
    std::vector<std::size_t> chosen(lambdas_.size());
    std::iota(chosen.begin(), chosen.end(), 0);
    if (!is_ordered(tradeoffs_, kChartSlack)) {
      for (const Found& found : found_) energies_.push_back(energies_of(found));
      search_again(cheapest());
      chosen = cheapest();
    }
    std::vector<std::vector<MappedChart>> maps;
    for (std::size_t k = 0; k < chosen.size(); ++k) maps.push_back(map_of(k, chosen[k]));
    return maps;
  }

 private:
  [[nodiscard]] Tradeoff tradeoff_of(const Found& found, std::size_t lambda) const {
    measure::DistortionSums sums;
    for (const MappedChart& part : found.parts)
      sums += measure::distortion_sums(part.chart->mesh, part.uv, executor_);
    const Distortion d = measure::distortion(sums);
    return {d.angle, d.area, lambda};
  }

  /// For each lambda: the mean over the parts.
  std::vector<double> energies_of(const Found& found) {
    std::vector<double> sum(lambdas_.size());
    double area = 0;
    for (const MappedChart& part : found.parts) {
      const TriMesh& mesh = part.chart->mesh;
      const auto rest = measure::flatten(mesh.positions, mesh.faces, executor_);
      const auto energies = solve::hybrid_energies({rest, mesh.faces, part.uv}, lambdas_,
                                                   options_.lambda_units, executor_);
      const double own = measure::area_of(rest);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += own * energies[k];
      area += own;
    }
    for (double& energy : sum) energy /= area;
    return sum;
  }

  /// The logarithm of the energy relative to that of the lambda's own map.
  double cost(std::size_t k, std::size_t candidate) const {
    if (candidate == k) return 0;
    const double ratio = (energies_[candidate][k] + kNothing) / (energies_[k][k] + kNothing);
    return std::max(kLeastCost, std::log(ratio));
  }

  std::vector<std::size_t> cheapest() const {
    return choose_in_order(tradeoffs_, lambdas_.size(), kChartSlack,
                           [this](std::size_t k, std::size_t c) { return cost(k, c); });
  }

  /// The nearest lambda that keeps its own map, in steps of +1 or -1 from k.
  static std::optional<std::size_t> kept_near(std::size_t k, int step,
                                              const std::vector<std::size_t>& chosen) {
    for (std::size_t j = k + static_cast<std::size_t>(step); j < chosen.size();
         j += static_cast<std::size_t>(step))  // wraps below 0
      if (chosen[j] == j) return j;
    return std::nullopt;
  }

  /// Adds maps for lambdas that lose their own: a short way down from their neighbours' maps. All
  /// from above come before those from below.
  void search_again(const std::vector<std::size_t>& chosen) {
    std::size_t left = (lambdas_.size() + 1) / 2;
    for (const int step : {1, -1})
      for (std::size_t k = 0; k < chosen.size() && left > 0; ++k) {
        if (chosen[k] == k || found_[k].solution.stop_reason == StopReason::direct) continue;
        if (const auto from = kept_near(k, step, chosen)) search(k, *from), --left;
      }
  }

  void search(std::size_t k, std::size_t start) {
    const int most = std::min(kShortDescent, options_.stop.max_iterations);
    found_.push_back(solver_.run_from(found_[start].solution.uv, lambdas_[k], most));
    tradeoffs_.push_back(tradeoff_of(found_.back(), k));
    energies_.push_back(energies_of(found_.back()));
  }

  /// A copy of a candidate for a lambda.
  [[nodiscard]] std::vector<MappedChart> map_of(std::size_t k, std::size_t candidate) const {
    std::vector<MappedChart> parts = found_[candidate].parts;
    const bool is_copy = tradeoffs_[candidate].lambda != k;
    for (MappedChart& part : parts) {
      if (candidate != k) part.report.stop_reason = StopReason::neighbour;
      if (!is_copy) continue;
      part.report.iterations = 0;
      part.report.energy = {energies_[candidate][k]};
    }
    return parts;
  }

  ChartSolver& solver_;
  const std::vector<double> lambdas_;
  std::vector<Found> found_;
  const UnwrapOptions& options_;
  Executor& executor_;
  std::vector<Tradeoff> tradeoffs_;
  std::vector<std::vector<double>> energies_;  // of each map found, for each lambda
};

/// The maps of the lambdas, in the order of the list.
std::vector<std::vector<MappedChart>> in_order(ChartSolver& solver,
                                               const std::vector<double>& lambdas,
                                               std::vector<Found> found,
                                               const UnwrapOptions& options, Executor& executor) {
  const std::vector<std::size_t> order = ascending_order(lambdas);
  std::vector<double> ascending;
  std::vector<Found> own;
  for (const std::size_t k : order) {
    ascending.push_back(lambdas[k]);
    own.push_back(std::move(found[k]));
  }
  MapsInOrder by(solver, std::move(ascending), std::move(own), options, executor);
  auto chosen = std::move(by).choose();
  std::vector<std::vector<MappedChart>> maps(lambdas.size());
  for (std::size_t k = 0; k < order.size(); ++k) maps[order[k]] = std::move(chosen[k]);
  return maps;
}

}  // namespace

std::vector<std::vector<MappedChart>> map_chart(const ChartJob& job, const UnwrapOptions& options,
                                                ChartProgress& progress, Executor& executor) {
  solve::Disk disk = job.disk;  // a copy, because jobs share the disk but not the stop token
  disk.stop = progress.stop();
  const std::vector<double> lambdas = lambdas_of(options);
  progress.begin_chart(job.chart->mesh.faces.size(), lambdas.size());
  throw_if_cancelled(disk.stop);
  ChartSolver solver(job, disk, options, progress, executor);
  std::vector<Found> found;
  for (const double lambda : lambdas) found.push_back(solver.run(lambda));
  std::vector<std::vector<MappedChart>> maps;
  if (keeps_order(options)) {
    maps = in_order(solver, lambdas, std::move(found), options, executor);
  } else {
    for (Found& own : found) maps.push_back(std::move(own.parts));
  }
  progress.end_chart();
  return maps;
}

}  // namespace unwrapd::pipeline
