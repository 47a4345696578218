#include "core/guarantee/guarantee_rules.hpp"

#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/base/executor.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/methods/symmetric_dirichlet.hpp"
#include "core/types/chart_rules.hpp"

namespace unwrapd::guarantee {
namespace {

constexpr double kLeastLambdaOfSizes = 0.01;
constexpr double kMostRise = 0.5;  // see GuaranteeRules::most_rise; of a segmented chart

/// The method's own energy, which a repair raises as little as possible. Methods that compute a map
/// from angles or scales have the energy of angles.
solve::arap::Rigidity rigidity_of(const solve::Disk& disk, const UnwrapOptions& options,
                                  double lambda) {
  switch (options.method) {
    case Method::arap:
    case Method::slim:
      return {};
    case Method::hybrid:
      if (options.lambda_units == LambdaUnits::dimensionless) return {lambda, false};
      return {lambda / (disk.unit * disk.unit), true};
    default:
      return {0, false};
  }
}

/// The energy that a map keeps low if it replaces the method's. A hybrid of small lambda counts as
/// a method of angles, because a map of little energy would shrink.
solve::repair::OwnEnergy own_energy_of(const solve::Disk& disk, const UnwrapOptions& options,
                                       const solve::arap::Rigidity& rigidity) {
  if (options.method == Method::slim) return solve::repair::OwnEnergy::symmetric_dirichlet;
  if (options.method == Method::arap) return solve::repair::OwnEnergy::fit;
  const double mean_area = 1.0 / static_cast<double>(disk.faces.size());
  const bool keeps_sizes =
      options.method == Method::hybrid && rigidity.at(mean_area) >= kLeastLambdaOfSizes;
  return keeps_sizes ? solve::repair::OwnEnergy::fit : solve::repair::OwnEnergy::mips;
}

/// With max_charts no chart is split for its energy. Otherwise a segmented chart, which is one of
/// many and has a bound of distortion, is split rather than given a new map of much energy. Any
/// other chart is split where that keeps the energy low, unless it must stay whole.
double most_rise_of(const charts::Chart& chart, const UnwrapOptions& options,
                    solve::repair::OwnEnergy own) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (options.max_charts) return kAny;
  if (chart.least == Guarantee::bijective) return kMostRise;
  return own == solve::repair::OwnEnergy::fit && !keeps_whole(options) ? kMostPressed : kAny;
}

/// The guarantee that is asked for, or a stronger one that the chart has by the way it was made.
Guarantee guarantee_of(const charts::Chart& chart, const UnwrapOptions& options) {
  if (options.guarantee == Guarantee::none) return Guarantee::none;
  return std::max(options.guarantee, chart.least);
}

double fit_energy_of(const solve::Disk& disk, const UvMap& uv,
                     const solve::arap::Rigidity& rigidity) {
  double energy = 0;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    check_cancelled_every(t, disk.stop);
    const measure::Jacobian j =
        measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv));
    const double lambda = rigidity.at(disk.rest[t].area);
    energy += solve::arap::fit_energy(j, solve::arap::fit_similarity(j, lambda), disk.rest[t].area,
                                      lambda);
  }
  return energy;
}

/// The method's own energy of a map. For methods of angles it is D_angle, which flipped triangles
/// have, too.
double energy_of(const solve::Disk& disk, const UvMap& uv, const solve::repair::MapIntent& intent) {
  SerialExecutor serial;
  switch (intent.own) {
    case solve::repair::OwnEnergy::symmetric_dirichlet:
      return solve::methods::symmetric_dirichlet_energy(disk, uv, serial);
    case solve::repair::OwnEnergy::mips:
      return measure::distortion_sums(disk.rest, disk.faces, uv, disk.stop).angle;
    default:
      return fit_energy_of(disk, uv, intent.rigidity);
  }
}

/// The energy of an isometric map.
double least_energy(const solve::Disk& disk, const solve::repair::MapIntent& intent) {
  double area = 0;
  for (const measure::RestTriangle& rest : disk.rest) area += rest.area;
  switch (intent.own) {
    case solve::repair::OwnEnergy::symmetric_dirichlet:
      return 4 * area;
    case solve::repair::OwnEnergy::mips:
      return 2 * area;
    default:
      return 0;
  }
}

}  // namespace

GuaranteeRules rules_for(const charts::Chart& chart, const solve::Disk& disk,
                         const UnwrapOptions& options, double lambda) {
  const solve::arap::Rigidity rigidity = rigidity_of(disk, options, lambda);
  const solve::repair::OwnEnergy own = own_energy_of(disk, options, rigidity);
  return {.guarantee = guarantee_of(chart, options),
          .repair = options.repair,
          .intent = {.rigidity = rigidity, .constrained = {}, .stop = disk.stop, .own = own},
          .most_rise = most_rise_of(chart, options, own)};
}

bool rises_too_far(const solve::Disk& disk, const GuaranteeRules& rules, const UvMap& uv,
                   const UvMap& other) {
  const double least = least_energy(disk, rules.intent), most = 1 + rules.most_rise;
  return energy_of(disk, uv, rules.intent) - least >
         most * (energy_of(disk, other, rules.intent) - least);
}

double energy_rise(const solve::Disk& disk, const GuaranteeRules& rules, const UvMap& before,
                   const UvMap& now) {
  const double energy = energy_of(disk, before, rules.intent);
  return energy > 0 ? std::max(0.0, energy_of(disk, now, rules.intent) / energy - 1) : 0;
}

}  // namespace unwrapd::guarantee
