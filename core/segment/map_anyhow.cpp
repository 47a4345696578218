#include "core/segment/map_anyhow.hpp"

#include "core/base/error.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/segment/base/region_mesh.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kEstimateTolerance = 1e-2;  // of energy, from iteration to iteration
constexpr std::size_t kMostPairs = 20;       // that are counted, for each face
constexpr double kUnknown = 1e3;             // excess, where no map was found

/// Pairs of faces that overlap, for each face.
double overlapping_share(std::span<const Triangle> faces, const UvMap& uv) {
  const std::size_t pairs = measure::overlapping_pairs(faces, uv, kMostPairs * faces.size()).size();
  return static_cast<double>(pairs) / static_cast<double>(faces.size());
}

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
  double energy = disk.unit * disk.unit * solution.energy.back();
  if (!is_sound) energy += kFlawedExcess * (1 + overlapping_share(own.mesh.faces, solution.uv));
  return {is_sound ? Verdict::sound : Verdict::flawed, {energy, energy}};
} catch (const Error&) {  // told to stop, or there is no map; a block must not throw
  return {Verdict::flawed, {kUnknown, kUnknown}};
}

}  // namespace unwrapd::segment
