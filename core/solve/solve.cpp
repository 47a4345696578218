// The methods side by side. ASAP is one direct solve; ARAP is the hybrid of infinite lambda.
//
// A hybrid of very small lambda has nothing to hold it open: with c the conformal energy of the
// ASAP map over its area, a map of uniform scale s costs c s^2 + lambda (s^2 - 1)^2 per area, whose
// only minimum for lambda <= c / 2 is s = 0. There the answer is the limit itself, the ASAP map.
#include "core/solve/solve.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/solve/conformal.hpp"
#include "core/solve/convex_map.hpp"

namespace unwrapd {
namespace {

/// Above this lambda no conformal map of use has energy enough to collapse the hybrid.
constexpr double kSafeLambda = 0.5;

UvMap scaled_to_unit_area(const Disk& disk, UvMap uv) {
  const double area = uv_area(disk.rest, disk.faces, uv);
  if (area > 0)
    for (Vec2& u : uv) u /= std::sqrt(area);
  return uv;
}

/// The paper's choice (Sec. 4.5) is mean_value for one boundary and lscm for several; but a surface
/// that is nearly developable is nearly solved by lscm, so for one boundary the better is taken.
UvMap best_map(const Disk& disk) {
  UvMap conformal = initial_map(disk, InitialMap::lscm);
  if (disk.loops.size() > 1) return conformal;
  UvMap convex = initial_map(disk, InitialMap::mean_value);
  const bool conformal_is_better =
      arap_energy(disk.rest, disk.faces, conformal) < arap_energy(disk.rest, disk.faces, convex);
  return conformal_is_better ? conformal : convex;
}

Rigidity rigidity_of(const Disk& disk, const UnwrapOptions& options) {
  if (options.method == Method::arap) return {};
  if (options.lambda_units == LambdaUnits::dimensionless) return {options.lambda, false};
  return {options.lambda / (disk.unit * disk.unit), true};  // Eq. (5) in units of area 1
}

/// The area-weighted mean of lambda_t.
double mean_lambda(const Disk& disk, const Rigidity& rigidity) {
  double sum = 0;
  for (const RestTriangle& rest : disk.rest) sum += rest.area * rigidity.at(rest.area);
  return sum;
}

Solution direct(const Disk& disk, UvMap uv) {
  Solution solution{.uv = std::move(uv), .energy = {}, .stop_reason = StopReason::direct};
  solution.energy.push_back(asap_energy(disk.rest, disk.faces, solution.uv));
  return solution;
}

Solution iterate(const Disk& disk, const UnwrapOptions& options, UvMap start,
                 const SolveWatch& watch, Executor& executor) {
  if (watch.on_stage) watch.on_stage(Stage::factor);
  const GlobalStep global(disk);
  if (watch.on_stage) watch.on_stage(Stage::solve);
  return local_global(disk, global, std::move(start),
                      {rigidity_of(disk, options), options.iterations}, watch.loop, executor);
}

}  // namespace

UvMap initial_map(const Disk& disk, InitialMap kind) {
  switch (kind) {
    case InitialMap::mean_value:
      return scaled_to_unit_area(disk, mean_value_map(disk));
    case InitialMap::tutte:
      return scaled_to_unit_area(disk, tutte_map(disk));
    case InitialMap::lscm:
      return conformal_map(disk, Pins::diameter);
    case InitialMap::automatic:
      break;
  }
  return best_map(disk);
}

Solution solve(const Disk& disk, const UnwrapOptions& options, const SolveWatch& watch,
               Executor& executor) {
  if (watch.on_stage) watch.on_stage(Stage::setup);
  if (options.method == Method::asap) {
    if (watch.on_stage) watch.on_stage(Stage::solve);
    return direct(disk, conformal_map(disk, options.pins));
  }
  const double lambda = mean_lambda(disk, rigidity_of(disk, options));
  if (lambda > kSafeLambda)
    return iterate(disk, options, initial_map(disk, options.initial), watch, executor);

  UvMap conformal = conformal_map(disk, options.pins);
  if (lambda <= asap_energy(disk.rest, disk.faces, conformal) / 2)
    return direct(disk, std::move(conformal));
  const bool open = options.initial == InitialMap::automatic || options.initial == InitialMap::lscm;
  UvMap start = open ? std::move(conformal) : initial_map(disk, options.initial);
  return iterate(disk, options, std::move(start), watch, executor);
}

}  // namespace unwrapd
