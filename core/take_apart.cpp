#include "core/take_apart.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/analyse.hpp"
#include "core/atlas/segment_charts.hpp"
#include "core/cancel.hpp"
#include "core/chart_watch.hpp"
#include "core/error.hpp"
#include "core/solve/kept.hpp"

namespace unwrapd {
namespace {

constexpr double kSegmentEnd = 0.50;  // of the job, where something is segmented

/// Constraints and boundary shapes are about whole components.
SegmentOptions segment_options(const UnwrapOptions& options) {
  return {
      .max_distortion = options.max_distortion,
      .max_charts = options.max_charts,
      .one_chart_each = !options.constraints.empty() || options.boundary != BoundaryShape::free};
}

std::vector<Disk> disks_of(const Charts& surface, Executor& executor) {
  std::vector<Disk> disks;
  disks.reserve(surface.charts.size());
  for (const Chart& chart : surface.charts) {
    disks.push_back(make_disk(chart.mesh, chart.loops, executor));
    disks.back().twin = chart.halfedges.twin;
    disks.back().stop = {};  // it may be kept for other jobs
  }
  return disks;
}

/// Where nothing is set aside it depends on numbers alone; what is follows from the charts, and
/// what it repeats from positions.
std::shared_ptr<const VertexPlan> plan_of(const Surface& surface, const Charts& own,
                                          SolverCore* core, const std::stop_token& stop) {
  const std::vector<const Chart*> charts = pointers_to(own.charts);
  Content content("vertex plan");
  content.add(surface.mesh.faces);
  if (!own.set_aside.empty()) content.add(surface.mesh.positions);
  for (const Chart* chart : charts) content.add(chart->mesh.faces).add(chart->face_source);
  const auto make = [&] {
    return std::make_shared<const VertexPlan>(plan_vertices(surface, own, charts, stop));
  };
  return kept(core, content, make, stop);
}

std::shared_ptr<const Prepared> prepare(std::span<const Surface> surfaces,
                                        const UnwrapOptions& options, const SegmentWatch& watch,
                                        Executor& executor) {
  auto prepared = std::make_shared<Prepared>();
  prepared->surfaces = components(surfaces, options, watch.stop, executor.shared_core());
  prepared->note = segment_charts(prepared->surfaces, segment_options(options), watch, executor);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const Charts& own = prepared->surfaces[s];
    prepared->disks.push_back(disks_of(own, executor));
    throw_if_cancelled(watch.stop);
    prepared->plans.push_back(plan_of(surfaces[s], own, executor.shared_core(), watch.stop));
  }
  return prepared;
}

/// Everything that prepare() looks at.
Digest digest_of(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const SolverCore& core) {
  const SegmentOptions segment = segment_options(options);
  const std::array<double, 1> distortion{segment.max_distortion.value_or(0)};  // which none is
  const std::array<int, 3> numbers{static_cast<int>(options.seams),
                                   static_cast<int>(segment.one_chart_each),
                                   segment.max_charts.value_or(0)};
  Content content("charts");
  content.add(distortion).add(numbers);
  std::vector<std::array<Index, 2>> paths;  // how many they are tells where surfaces begin
  for (const SeamPath& path : options.seam_edges)
    paths.push_back({path.surface, static_cast<Index>(path.vertices.size())});
  content.add(paths);
  for (const SeamPath& path : options.seam_edges) content.add(path.vertices);
  for (const Surface& surface : surfaces) {
    content.add(surface.mesh.positions).add(surface.mesh.faces).add(surface.part);
    if (options.seams == SeamMode::uv0) content.add(surface.corner_uv);
  }
  return core.digest(content);
}

std::size_t bytes_of_charts(const Charts& surface) {
  std::size_t bytes = bytes_of(surface.set_aside) + bytes_of(surface.repeats);
  bytes += bytes_of(*surface.by_position);
  for (const Chart& chart : surface.charts) bytes += bytes_of(chart);
  return bytes;
}

std::size_t bytes_of_disk(const Disk& disk) {
  return sizeof(Disk) + bytes_of(disk.positions) + bytes_of(disk.rest) +
         bytes_of(disk.corners.begin) + bytes_of(disk.corners.corner);
}

}  // namespace

std::size_t bytes_of(const Prepared& prepared) {
  std::size_t bytes = sizeof(Prepared) + prepared.note.size();
  for (const Charts& surface : prepared.surfaces) bytes += bytes_of_charts(surface);
  for (const std::vector<Disk>& disks : prepared.disks)
    for (const Disk& disk : disks) bytes += bytes_of_disk(disk);
  for (const auto& plan : prepared.plans) bytes += bytes_of(*plan);
  return bytes;
}

TakenApart take_apart(std::span<const Surface> surfaces, const UnwrapOptions& options,
                      const Progress& progress, Executor& executor) {
  TakenApart taken{nullptr, kSolveBegin};
  const auto on_progress = [&](Stage stage, double share) {
    taken.solve_begin = kSegmentEnd;
    if (progress.on_stage)
      progress.on_stage({stage, 0, 0, kChartsBegin + (kSegmentEnd - kChartsBegin) * share});
  };
  const SegmentWatch watch{on_progress, progress.stop};
  const auto make = [&] { return prepare(surfaces, options, watch, executor); };
  SolverCore* core = executor.shared_core();
  if (core == nullptr) {
    taken.all = make();
    return taken;
  }
  check_memory(job_bytes(surfaces), core->memory_limit());
  const auto made = [&]() -> SolverCore::Made {
    const std::shared_ptr<const Prepared> prepared = make();
    return {prepared, bytes_of(*prepared)};
  };
  taken.all = std::static_pointer_cast<const Prepared>(
      core->obtain(digest_of(surfaces, options, *core), made, progress.stop));
  return taken;
}

}  // namespace unwrapd
