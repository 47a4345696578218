#include "core/pipeline/straighten_charts.hpp"

#include <optional>
#include <utility>

#include "core/solve/base/disk.hpp"
#include "core/solve/straighten.hpp"

namespace unwrapd::pipeline {

void straighten_charts(Layout& layout, const UnwrapOptions& options, Executor& executor) {
  if (options.straighten == Straighten::off) return;
  const double bound = options.max_distortion.value_or(kDefaultDistortion);
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k) {
      const charts::Chart& chart = *layout.charts[s][k];
      const solve::Disk disk = solve::make_disk(chart.mesh, chart.loops, executor);
      std::optional<UvMap> straight = solve::straightened(disk, layout.islands[s][k]);
      if (!straight) continue;
      const Distortion own =
          measure::distortion(measure::distortion_sums(disk.rest, disk.faces, *straight, executor));
      if (own.angle <= bound && own.area <= bound) layout.islands[s][k] = std::move(*straight);
    }
}

}  // namespace unwrapd::pipeline
