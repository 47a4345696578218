#include "core/solve/hybrid_energy.hpp"

#include <cmath>

#include "core/measure/distortion.hpp"
#include "core/solve/arap/local_step.hpp"

namespace unwrapd::solve {
namespace {

measure::Jacobian scaled(const measure::Jacobian& j, double by) {
  return {by * j.e, by * j.h, by * j.f, by * j.g};
}

}  // namespace

std::vector<double> hybrid_energies(const MappedFaces& map, std::span<const double> lambdas,
                                    LambdaUnits units, Executor& executor) {
  const double area = measure::area_of(map.rest);
  const double even = std::sqrt(area / measure::uv_area(map.rest, map.faces, map.uv, executor));
  std::vector<std::vector<double>> sums(part_count(map.rest.size()),
                                        std::vector<double>(lambdas.size()));
  for_each_part(map.rest.size(), executor, [&](std::size_t part, std::size_t t, std::size_t end) {
    for (; t < end; ++t) {
      const double own = map.rest[t].area;
      const measure::Jacobian j =
          scaled(measure::jacobian(map.rest[t], measure::uv_edges(map.faces[t], map.uv)), even);
      for (std::size_t k = 0; k < lambdas.size(); ++k) {
        const double lambda = arap::Rigidity{lambdas[k], units == LambdaUnits::paper}.at(own);
        sums[part][k] += arap::fit_energy(j, arap::fit_similarity(j, lambda), own, lambda);
      }
    }
  });
  std::vector<double> energy(lambdas.size());
  for (const std::vector<double>& part : sums)
    for (std::size_t k = 0; k < energy.size(); ++k) energy[k] += part[k] / area;
  return energy;
}

}  // namespace unwrapd::solve
