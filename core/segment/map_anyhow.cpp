#include "core/segment/map_anyhow.hpp"

#include "core/base/error.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/segment/base/region_mesh.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kEstimateTolerance = 1e-2;  // of energy, from iteration to iteration
constexpr double kFlawed = 3;                // times the excess of a sound map
constexpr double kUnknown = 1e3;             // excess, where no map was found

}  // namespace

TestResult map_anyhow(const SegmentationMesh& surface, std::span<const char> open,
                      const std::stop_token& stop, Region& region) try {
  const RegionMesh own = region_mesh(surface, open, region.faces);
  if (!is_disk(own)) return {};
  const solve::Disk disk = solve::make_disk(own.mesh, own.loops, stop);
  UnwrapOptions options;
  options.stop.tolerance = kEstimateTolerance;
  SerialExecutor serial;
  solve::SolveWatch watch;
  watch.loop.stop = stop;
  region.mapped = 0;  // all of it is mapped
  const solve::Solution solution = solve::Solver(disk, options, {}, serial).run(0, watch);
  for (std::size_t t = 0; t < region.uv.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      region.uv[t][i] = disk.unit * solution.uv[own.mesh.faces[t][i]];
  const bool is_sound = measure::is_plainly_injective(own.mesh.faces, own.loops, solution.uv, stop);
  const double energy = disk.unit * disk.unit * solution.energy.back() + (is_sound ? 0 : kFlawed);
  return {is_sound ? Verdict::sound : Verdict::flawed, {energy, energy}};
} catch (const Error&) {  // told to stop, or there is no map; a block must not throw
  return {Verdict::flawed, {kUnknown, kUnknown}};
}

}  // namespace unwrapd::segment
