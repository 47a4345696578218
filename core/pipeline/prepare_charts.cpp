#include "core/pipeline/prepare_charts.hpp"

#include <algorithm>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/pipeline/analyse.hpp"
#include "core/pipeline/assemble.hpp"
#include "core/pipeline/chart_progress.hpp"
#include "core/segment/segment_charts.hpp"
#include "core/solve/base/cached.hpp"
#include "core/types/chart_rules.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr double kSegmentEnd = 0.50;  // of the job, where something is segmented

segment::SegmentOptions segment_options(const UnwrapOptions& options) {
  return {.max_distortion = options.max_distortion,
          .max_charts = options.max_charts,
          .effort = options.effort,
          .one_chart_each = keeps_whole(options),
          .symmetry = options.symmetry};
}

std::vector<solve::Disk> disks_of(const charts::Charts& surface, Executor& executor) {
  std::vector<solve::Disk> disks;
  disks.reserve(surface.charts.size());
  for (const charts::Chart& chart : surface.charts) {
    disks.push_back(solve::make_disk(chart.mesh, chart.loops, executor));
    disks.back().twin =
        known_by_bytes(executor.shared_cache(), ListView<Index>(chart.halfedges.twin));
    disks.back().stop = {};  // it may be kept for other jobs
  }
  return disks;
}

/// All that a job's options say of how surfaces come apart.
struct TakingApart {
  segment::SegmentOptions segment;
  SeamMode seams;
  std::span<const SeamPath> paths, kept;
};

void describe(CacheKey& key, const TakingApart& rules) {
  const auto& [segment, seams, paths, kept] = rules;
  key.add(segment).add(seams).add(paths).add(kept);
}

/// How surfaces are taken apart: watched.
struct Preparing : solve::CacheContext {
  const segment::SegmentWatch& watch;
};

std::shared_ptr<const Prepared> prepare(const Preparing& by, std::span<const Surface> surfaces,
                                        const TakingApart& rules) {
  auto prepared = std::make_shared<Prepared>();
  prepared->surfaces =
      components(surfaces, {rules.seams, rules.paths, 0, by.stop, by.core, rules.kept});
  require_area(prepared->surfaces);
  prepared->note =
      segment::segment_charts(prepared->surfaces, rules.segment, by.watch, *by.executor);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const charts::Charts& own = prepared->surfaces[s];
    prepared->disks.push_back(disks_of(own, *by.executor));
    throw_if_cancelled(by.stop);
    prepared->plans.push_back(std::make_shared<const VertexPlan>(
        plan_vertices(surfaces[s], own, pointers_to(own.charts), by.stop)));
  }
  return prepared;
}

std::size_t bytes_of_charts(const charts::Charts& surface) {
  std::size_t bytes = solve::bytes_of(surface.set_aside) + solve::bytes_of(surface.repeats);
  bytes += solve::bytes_of(*surface.by_position);
  for (const charts::Chart& chart : surface.charts) bytes += charts::bytes_of(chart);
  return bytes;
}

std::size_t bytes_of_disk(const solve::Disk& disk) {
  return sizeof(solve::Disk) + solve::bytes_of(disk.positions) + solve::bytes_of(disk.rest) +
         solve::bytes_of(disk.corners.begin) + solve::bytes_of(disk.corners.corner);
}

}  // namespace

std::size_t bytes_of(const Prepared& prepared) {
  std::size_t bytes = sizeof(Prepared) + (prepared.note ? prepared.note->text.size() : 0);
  for (const charts::Charts& surface : prepared.surfaces) bytes += bytes_of_charts(surface);
  for (const std::vector<solve::Disk>& disks : prepared.disks)
    for (const solve::Disk& disk : disks) bytes += bytes_of_disk(disk);
  for (const auto& plan : prepared.plans) bytes += bytes_of(*plan);
  return bytes;
}

PreparedCharts prepare_charts(std::span<const Surface> surfaces, const UnwrapOptions& options,
                              const Progress& progress, Executor& executor) {
  PreparedCharts taken{nullptr, kSolveBegin};
  const auto on_progress = [&](Stage stage, double share) {
    taken.solve_begin = kSegmentEnd;
    if (progress.on_stage)
      progress.on_stage({stage, 0, 0, kChartsBegin + (kSegmentEnd - kChartsBegin) * share});
  };
  const segment::SegmentWatch watch{on_progress, progress.stop};
  SharedCache* core = executor.shared_cache();
  if (core != nullptr) check_memory(job_bytes(surfaces), core->memory_limit());
  const TakingApart rules{segment_options(options), options.seams, options.seam_edges,
                          options.keep_edges};
  taken.all =
      solve::cached<prepare>(Preparing{{core, progress.stop, &executor}, watch}, surfaces, rules);
  return taken;
}

}  // namespace unwrapd::pipeline
