// Yang, Kim, Luo, Hu, Gu, "Optimal Surface Parameterization Using Inverse Curvature Map", IEEE TVCG
// 14(5), 2008. The curvature K is an invertible function of the radii' logarithms u of a circle
// packing metric; its Jacobian is a Laplacian with weights >= 0, the Hessian of a convex function
// (Chow, Luo 2003). The paper integrates K back to u along a path ("curvature diffusion", dK = L
// du); Newton's method has the same limit, K = 0 inside and u unchanged on the boundary, in four to
// seven solves.
#include "core/solve/methods/ic.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/solve/base/metric.hpp"
#include "core/solve/maps/fill_holes.hpp"
#include "core/solve/maps/lay_out.hpp"
#include "core/solve/methods/circle_packing.hpp"

namespace unwrapd::solve::methods {
namespace {

constexpr double kFlat = 1e-9;  // radians
constexpr int kMaxIterations = 50;
constexpr int kMaxHalvings = 20;
constexpr double kMostGrowth = 4;       // of a log radius in one step
constexpr double kLeastWeight = 1e-14;  // of a side; circles a million times apart have less

/// Moves the circles of one disk towards a flat metric.
class Flow {
 public:
  explicit Flow(const Disk& disk)
      : disk_(disk),
        on_boundary_(boundary_vertices(disk)),
        packing_(circle_packing(disk)),
        packed_(packed_angles(disk, packing_)) {}

  [[nodiscard]] double greatest_curvature() const {
    return inner_curvature(disk_, packed_.curvature);
  }

  /// One Newton step of u towards K = 0, halved until the sum of K^2 falls. False if it does not
  /// fall.
  bool step() {
    const std::vector<double> change = newton_direction();
    const double before = sum_of_squares(packed_);
    double share = std::min(1.0, kMostGrowth / greatest(change));
    for (int k = 0; k < kMaxHalvings; ++k, share /= 2) {
      CirclePacking next = packing_;
      for (std::size_t v = 0; v < change.size(); ++v) next.log_radius[v] += share * change[v];
      PackedAngles packed = packed_angles(disk_, next);
      if (!(sum_of_squares(packed) < before)) continue;
      packing_ = std::move(next), packed_ = std::move(packed);
      return true;
    }
    return false;
  }

  [[nodiscard]] std::vector<measure::RestTriangle> triangles() const {
    std::vector<measure::RestTriangle> flat;
    flat.reserve(packed_.angle.size());
    for (const auto& angle : packed_.angle) flat.push_back(maps::triangle_of_angles(angle));
    return flat;
  }

 private:
  static double greatest(std::span<const double> change) {
    double most = 0;
    for (double x : change) most = std::max(most, std::abs(x));
    return most;
  }

  [[nodiscard]] std::vector<double> newton_direction() const {
    std::vector<double> weight = packed_.weight;
    for (double& w : weight) w = std::max(w, kLeastWeight);
    const InnerSystem jacobian(
        disk_, linear::lower_laplacian(disk_.faces, disk_.vertex_count(), weight, disk_.stop));
    return flat_scales(disk_, jacobian, packed_.curvature);
  }

  [[nodiscard]] double sum_of_squares(const PackedAngles& packed) const {
    double sum = 0;
    for (std::size_t v = 0; v < on_boundary_.size(); ++v)
      if (on_boundary_[v] == 0) sum += packed.curvature[v] * packed.curvature[v];
    return sum;
  }

  const Disk& disk_;
  std::vector<char> on_boundary_;
  CirclePacking packing_;
  PackedAngles packed_;
};

UvMap lay_out_circles(const Disk& disk, const maps::FilledDisk& filled, const Flow& flow) {
  UvMap uv = maps::lay_out(filled.disk, flow.triangles());
  uv.resize(disk.positions.size());
  maps::scale_to_area(disk, uv);
  return uv;
}

}  // namespace

Solution ic(const Disk& disk, const SolveWatch& watch) {
  throw_if_cancelled(watch.loop.stop);
  const maps::FilledDisk filled = maps::fill_holes(disk);
  Flow flow(filled.disk);
  if (watch.on_stage) watch.on_stage(Stage::solve);
  Solution solution{
      .uv = {}, .energy = {flow.greatest_curvature()}, .stop_reason = StopReason::max_iterations};
  while (solution.energy.back() > kFlat && solution.iterations < kMaxIterations) {
    throw_if_cancelled(watch.loop.stop);
    if (!flow.step()) break;
    ++solution.iterations;
    solution.energy.push_back(flow.greatest_curvature());
    if (!watch.loop.on_iteration) continue;
    solution.uv = lay_out_circles(disk, filled, flow);
    watch.loop.on_iteration(solution);
  }
  if (solution.energy.back() <= kFlat) solution.stop_reason = StopReason::converged;
  solution.uv = lay_out_circles(disk, filled, flow);
  return solution;
}

}  // namespace unwrapd::solve::methods
