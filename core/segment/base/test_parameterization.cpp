// Liu et al. 2008, Sec. 4.4, cut short: rotations are all that an ARAP iteration asks of the map
// before it, so the maps of two neighbours, laid side by side, are start enough for their union. No
// embedding, no second factorisation, and four iterations show what converged ones would.
#include "core/segment/base/test_parameterization.hpp"

#include <cmath>
#include <cstdint>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/measure/overlaps.hpp"
#include "core/segment/base/failed_trials.hpp"
#include "core/segment/base/region_mesh.hpp"
#include "core/solve/arap/global_step.hpp"
#include "core/solve/arap/objective.hpp"

namespace unwrapd::segment {
namespace {

/// In the units of the surface: what the solver reads of a disk does not ask for area 1, nor do
/// these steps read its boundary.
solve::Disk disk_of(const RegionMesh& region, const MovingPart& part, const std::stop_token& stop) {
  std::vector<Vec3> positions;
  positions.reserve(part.vertices.size());
  for (const Index v : part.vertices) positions.push_back(region.mesh.positions[v]);
  std::vector<measure::RestTriangle> rest;
  rest.reserve(part.faces.size());
  for (const Index t : part.faces) rest.push_back(region.rest[t]);
  return {.faces = part.corners,
          .loops = {},
          .positions = std::move(positions),
          .rest = std::move(rest),
          .corners = {},
          .unit = 1,
          .is_ordered = true,
          .stop = stop};
}

/// The global step from the rotations of triangles that need not hold together.
UvMap stitched(const solve::Disk& disk, std::span<const CornerUv> seed,
               const solve::VertexConstraints& held, const solve::arap::GlobalStep& global) {
  UvMap uv(disk.positions.size(), Vec2::Zero()), force = uv;
  for (const solve::HardConstraint& point : held.hard) uv[point.vertex] = point.at;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    const measure::RestTriangle& rest = disk.rest[t];
    const auto& [a, b, c] = seed[t];
    const solve::arap::Similarity turn = solve::arap::fit_similarity(
        measure::jacobian(rest, {a - b, b - c, c - a}), solve::arap::Rigidity{}.lambda);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2& x = rest.edge[i];
      const Vec2 turned(turn.a * x.x() + turn.b * x.y(), turn.a * x.y() - turn.b * x.x());
      const Index from = disk.faces[t][i], to = disk.faces[t][(i + 1) % 3];
      const Vec2 pull = rest.cot[i] * (turned - (uv[from] - uv[to]));
      force[from] += pull;
      force[to] -= pull;
    }
  }
  global.solve(force);
  for (std::size_t v = 0; v < uv.size(); ++v) uv[v] += force[v];
  return uv;
}

UvMap arap_map(const solve::Disk& disk, const TestRules& rules, std::span<const CornerUv> seed,
               const solve::VertexConstraints& held) {
  SerialExecutor serial;
  JobExecutor job(serial, rules.stop);
  const solve::arap::GlobalStep global(disk, held, &job);
  UvMap uv = stitched(disk, seed, held, global);
  solve::arap::Objective objective(disk, {}, held, global.rank(), job);
  uv = solve::arap::by_rank(uv, global.rank());
  std::vector<Vec2> step(uv.size());
  for (int k = 1; k < rules.iterations && !is_cancelled(rules.stop); ++k) {
    objective.evaluate(uv, step);
    global.solve_by_rank(step);
    for (std::size_t v = 0; v < uv.size(); ++v) uv[v] += step[v];
  }
  return solve::arap::by_vertex(uv, global.rank());
}

/// The map of the whole region: that of the seed, but anew where it may move.
UvMap map_of(const RegionMesh& region, const TestRules& rules, const Region& seed) {
  const MovingPart part = moving_part(region, seed.mapped, seed.uv);
  std::vector<CornerUv> own;
  own.reserve(part.faces.size());
  for (const Index t : part.faces) own.push_back(seed.uv[t]);
  const UvMap moved = arap_map(disk_of(region, part, rules.stop), rules, own, part.held);
  UvMap uv(region.mesh.positions.size());
  for (std::size_t t = 0; t < seed.mapped; ++t)
    for (std::size_t i = 0; i < 3; ++i) uv[region.mesh.faces[t][i]] = seed.uv[t][i];
  for (std::size_t k = 0; k < moved.size(); ++k) uv[part.vertices[k]] = moved[k];
  return uv;
}

Verdict verdict_on(const RegionMesh& region, const measure::DistortionSums& sums,
                   const TestRules& rules, const UvMap& uv) {
  if (sums.flipped > 0) return Verdict::flawed;
  if (!(excess_of(sums).worst() <= rules.most_excess)) return Verdict::distorted;
  return measure::is_plainly_injective(region.mesh.faces, region.loops, uv, rules.stop)
             ? Verdict::sound
             : Verdict::flawed;
}

TestResult tried(const SegmentationMesh& surface, std::span<const char> open,
                 const TestRules& rules, Region& region) try {
  const RegionMesh own = region_mesh(surface, open, region.faces);
  if (!is_disk(own)) return {};
  const UvMap uv = map_of(own, rules, region);
  const measure::DistortionSums sums = measure::distortion_sums(own.rest, own.mesh.faces, uv);
  const TestResult result{verdict_on(own, sums, rules, uv), excess_of(sums)};
  region.mapped = 0;
  const double scale = sums.uv_area > 0 ? std::sqrt(sums.area / sums.uv_area) : 1;
  for (std::size_t t = 0; t < region.uv.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) region.uv[t][i] = scale * uv[own.mesh.faces[t][i]];
  return result;
} catch (const Error&) {  // told to stop, or the system was too ill-conditioned to factor
  return {Verdict::flawed, {}};
}

}  // namespace

ExcessDistortion excess_of(const measure::DistortionSums& sums) {
  if (!(sums.measured > 0)) return {};
  return {sums.angle - 2 * sums.measured,
          sums.inverse * sums.measured_uv / sums.measured - sums.measured};
}

TestResult test_parameterization(const SegmentationMesh& surface, std::span<const char> open,
                                 const TestRules& rules, Region& region) {
  if (rules.memory == nullptr) return tried(surface, open, rules, region);
  const std::uint64_t key = trial_key(open, rules, region);
  if (const auto known = rules.memory->find(key, rules.most_excess)) return *known;
  const TestResult result = tried(surface, open, rules, region);
  if (!is_cancelled(rules.stop)) rules.memory->keep(key, result);
  return result;
}

}  // namespace unwrapd::segment
