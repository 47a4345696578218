// Ben-Chen, Gotsman, Bunin, "Conformal Flattening by Curvature Prescription and Metric Scaling",
// Eurographics 2008: find the log scale factors u that move all curvature to the boundary, multiply
// each edge by the mean of exp(u) along it, and draw the triangles that have these lengths.
// u = 0 on the boundary lets each boundary vertex take what curvature it needs; of all conformal
// maps that one distorts areas least (Springborn, Schroeder, Pinkall 2008).
// One linear solve is exact to first order only: on coarse meshes some triples of lengths are those
// of no triangle. Raised to the least height, such slivers outweigh all others when the map is
// drawn (D_angle 4.3 on the Gargoyle); keeping their shape in space costs next to nothing (2.00).
#include "core/solve/methods/cp.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/cancel.hpp"
#include "core/solve/base/metric.hpp"
#include "core/solve/maps/fill_holes.hpp"
#include "core/solve/maps/lay_out.hpp"

namespace unwrapd::solve::methods {
namespace {

/// A triangle may lose at most this share of its height over its longest edge.
constexpr double kMostThinning = 0.9;

/// (1/l) times the integral of exp(u) along an edge on which u is linear between its ends' values.
double mean_scale(double a, double b) {
  const double half = (b - a) / 2;
  const double spread = std::abs(half) < 1e-4 ? 1 + half * half / 6 : std::sinh(half) / half;
  return std::exp((a + b) / 2) * spread;
}

double slenderness(const measure::RestTriangle& triangle) {
  const EdgeLengths l = edge_lengths(triangle);
  const double longest = std::max({l[0], l[1], l[2]});
  return 2 * triangle.area / (longest * longest);
}

/// u: at the corners. The size of the result is arbitrary.
measure::RestTriangle scale_metric(const measure::RestTriangle& triangle,
                                   const std::array<double, 3>& u) {
  const double greatest = std::max({u[0], u[1], u[2]});  // against overflow
  EdgeLengths l = edge_lengths(triangle);
  for (std::size_t i = 0; i < 3; ++i)
    l[i] *= mean_scale(u[i] - greatest, u[(i + 1) % 3] - greatest);
  const measure::RestTriangle flat = maps::triangle_of_lengths(l);
  return slenderness(flat) < (1 - kMostThinning) * slenderness(triangle) ? triangle : flat;
}

std::vector<measure::RestTriangle> scale_metric(const Disk& disk, std::span<const double> u) {
  std::vector<measure::RestTriangle> flat;
  flat.reserve(disk.rest.size());
  for (std::size_t t = 0; t < disk.rest.size(); ++t) {
    const auto at = [&](std::size_t i) { return u[static_cast<std::size_t>(disk.faces[t][i])]; };
    flat.push_back(scale_metric(disk.rest[t], {at(0), at(1), at(2)}));
  }
  return flat;
}

}  // namespace

Solution cp(const Disk& disk, const SolveWatch& watch) {
  const maps::FilledDisk filled = maps::fill_holes(disk);
  const std::vector<double> bent = curvature(filled.disk, filled.disk.rest);
  throw_if_cancelled(watch.loop.stop);
  if (watch.on_stage) watch.on_stage(Stage::factor);
  const InnerSystem inner(filled.disk, cotan_laplacian(filled.disk, filled.disk.rest));
  const std::vector<double> u = flat_scales(filled.disk, inner, bent);
  throw_if_cancelled(watch.loop.stop);
  if (watch.on_stage) watch.on_stage(Stage::solve);
  std::vector<measure::RestTriangle> flat = scale_metric(filled.disk, u);
  const std::vector<double> left = curvature(filled.disk, flat);
  Solution solution{.uv = maps::lay_out(filled.disk, std::move(flat)),
                    .energy = {inner_curvature(filled.disk, bent)},
                    .stop_reason = StopReason::direct};
  solution.uv.resize(disk.positions.size());
  maps::scale_to_area(disk, solution.uv);
  solution.energy.push_back(inner_curvature(filled.disk, left));
  solution.iterations = 1;
  if (watch.loop.on_iteration) watch.loop.on_iteration(solution);
  return solution;
}

}  // namespace unwrapd::solve::methods
