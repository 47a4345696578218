// Liu et al. 2008, Sec. 4.4, cut short: rotations are all that an ARAP iteration asks of the map
// before it, so the maps of two neighbours, laid side by side, are start enough for their union. No
// embedding, no second factorisation, and four iterations show what converged ones would.
#include "core/segment/test_parameterization.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/measure/overlaps.hpp"
#include "core/mesh/topology.hpp"
#include "core/segment/failed_trials.hpp"
#include "core/segment/ranks.hpp"
#include "core/solve/arap/global_step.hpp"
#include "core/solve/arap/objective.hpp"

namespace unwrapd::segment {
namespace {

/// The region as a mesh of its own.
struct Part {
  TriMesh mesh;
  Halfedges halfedges;
  std::vector<BoundaryLoop> loops;
};

Halfedges glued(const SegmentationMesh& surface, std::span<const char> open,
                std::span<const Index> faces) {
  const Ranks rank(surface.mesh.faces.size(), faces);
  Halfedges own;
  own.twin.reserve(3 * faces.size());
  for (const Index t : faces)
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index twin = open.empty() || open[h] == 0 ? surface.halfedges.twin[h] : kNoTwin;
      const bool inside = twin != kNoTwin && rank[face_of(twin)] != kNoTwin;
      own.twin.push_back(inside ? 3 * rank[face_of(twin)] + twin % 3 : kNoTwin);
    }
  return own;
}

/// Numbers vertices as the surface would eliminate them, those that are one on the surface as they
/// come.
void renumber(const SegmentationMesh& surface, std::span<const Index> faces,
              CornerVertices& corners) {
  std::vector<std::uint64_t> key(static_cast<std::size_t>(corners.count));
  for (std::size_t k = 0; k < faces.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto v = static_cast<std::uint64_t>(corners.faces[k][i]);
      const Index rank = surface.rank[surface.mesh.faces[faces[k]][i]];
      key[v] = static_cast<std::uint64_t>(rank) << 32 | v;
    }
  std::ranges::sort(key);
  std::vector<Index> number(key.size());
  for (std::size_t n = 0; n < key.size(); ++n) number[key[n] & 0xffffffff] = static_cast<Index>(n);
  for (Triangle& face : corners.faces)
    for (Index& v : face) v = number[v];
}

Part part_of(const SegmentationMesh& surface, std::span<const char> open,
             std::span<const Index> faces) {
  Part part{{}, glued(surface, open, faces), {}};
  CornerVertices corners = corner_vertices(part.halfedges);
  renumber(surface, faces, corners);
  part.mesh = {std::vector<Vec3>(corners.count), std::move(corners.faces)};
  for (std::size_t k = 0; k < faces.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      part.mesh.positions[part.mesh.faces[k][i]] =
          surface.mesh.positions[surface.mesh.faces[faces[k]][i]];
  return part;
}

/// In one piece, with a boundary and without a handle: V - E + F is 2 less the boundaries.
bool is_disk(const Part& part) {
  const auto face_count = static_cast<Index>(part.mesh.faces.size());
  Index sides = 0;
  for (const BoundaryLoop& loop : part.loops) sides += static_cast<Index>(loop.size());
  const Index euler = part.mesh.vertex_count() - (3 * face_count + sides) / 2 + face_count;
  if (part.loops.empty() || euler != 2 - static_cast<Index>(part.loops.size())) return false;
  std::vector<char> reached(part.mesh.faces.size(), 0);
  std::vector<Index> pending{0};
  reached[0] = 1;
  for (std::size_t k = 0; k < pending.size(); ++k)
    for (Index h = 3 * pending[k]; h < 3 * pending[k] + 3; ++h) {
      const Index twin = part.halfedges.twin[h];
      if (twin == kNoTwin || std::exchange(reached[face_of(twin)], 1) != 0) continue;
      pending.push_back(face_of(twin));
    }
  return pending.size() == part.mesh.faces.size();
}

/// In the units of the surface: what the solver reads of a part does not ask for area 1.
solve::Disk disk_of(const SegmentationMesh& surface, std::span<const Index> faces, const Part& part,
                    const std::stop_token& stop) {
  std::vector<measure::RestTriangle> rest;
  rest.reserve(faces.size());
  for (const Index t : faces) rest.push_back(surface.rest[t]);
  return {.faces = part.mesh.faces,
          .loops = part.loops,
          .positions = part.mesh.positions,
          .rest = std::move(rest),
          .corners = linear::vertex_corners(part.mesh.faces, part.mesh.vertex_count()),
          .unit = 1,
          .is_ordered = true,
          .stop = stop};
}

/// The global step from the rotations of triangles that need not hold together.
UvMap stitched(const solve::Disk& disk, std::span<const CornerUv> seed,
               const solve::arap::GlobalStep& global) {
  UvMap uv(disk.positions.size(), Vec2::Zero());
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    const measure::RestTriangle& rest = disk.rest[t];
    const auto& [a, b, c] = seed[t];
    const solve::arap::Similarity turn = solve::arap::fit_similarity(
        measure::jacobian(rest, {a - b, b - c, c - a}), solve::arap::Rigidity{}.lambda);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2& x = rest.edge[i];
      const Vec2 pull =
          rest.cot[i] * Vec2(turn.a * x.x() + turn.b * x.y(), turn.a * x.y() - turn.b * x.x());
      uv[disk.faces[t][i]] += pull;
      uv[disk.faces[t][(i + 1) % 3]] -= pull;
    }
  }
  global.solve(uv);
  return uv;
}

UvMap arap_map(const solve::Disk& disk, const TestRules& rules, std::span<const CornerUv> seed) {
  const solve::VertexConstraints nothing;
  SerialExecutor serial;
  JobExecutor job(serial, rules.stop);
  const solve::arap::GlobalStep global(disk, nothing, &job);
  UvMap uv = stitched(disk, seed, global);
  solve::arap::Objective objective(disk, {}, nothing, global.rank(), job);
  uv = solve::arap::by_rank(uv, global.rank());
  std::vector<Vec2> step(uv.size());
  for (int k = 1; k < rules.iterations && !is_cancelled(rules.stop); ++k) {
    objective.evaluate(uv, step);
    global.solve_by_rank(step);
    for (std::size_t v = 0; v < uv.size(); ++v) uv[v] += step[v];
  }
  return solve::arap::by_vertex(uv, global.rank());
}

Verdict verdict_on(const solve::Disk& disk, const measure::DistortionSums& sums,
                   const TestRules& rules, const UvMap& uv) {
  if (sums.flipped > 0) return Verdict::flawed;
  if (!(excess_of(sums).worst() <= rules.most_excess)) return Verdict::distorted;
  return measure::is_plainly_injective(disk.faces, disk.loops, uv, disk.stop) ? Verdict::sound
                                                                              : Verdict::flawed;
}

TestResult tried(const SegmentationMesh& surface, std::span<const char> open,
                 const TestRules& rules, Region& region) try {
  Part part = part_of(surface, open, region.faces);
  part.loops = boundary_loops(part.mesh, part.halfedges);
  if (!is_disk(part)) return {};
  const solve::Disk disk = disk_of(surface, region.faces, part, rules.stop);
  UvMap uv = arap_map(disk, rules, region.uv);
  const measure::DistortionSums sums = measure::distortion_sums(disk.rest, disk.faces, uv);
  const TestResult result{verdict_on(disk, sums, rules, uv), excess_of(sums)};
  const double scale = sums.uv_area > 0 ? std::sqrt(sums.area / sums.uv_area) : 1;
  for (std::size_t t = 0; t < disk.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) region.uv[t][i] = scale * uv[disk.faces[t][i]];
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
