#include "server/run_job.hpp"

#include <algorithm>
#include <array>

#include "api/events.hpp"
#include "api/options.hpp"
#include "api/report.hpp"
#include "core/asset/asset.hpp"
#include "core/figure/layout_svg.hpp"
#include "core/unwrap.hpp"
#include "server/job_input.hpp"
#include "server/map_choice.hpp"
#include "server/result_store.hpp"
#include "server/stage_clock.hpp"
#include "server/uv_file.hpp"

namespace unwrapd::server {
namespace {

constexpr double kWriteFraction = 0.95;  // of the job is done when writing begins

void check_stop(const RunningJob& job) {
  if (job.stop.stop_requested())
    throw Error(ErrorCode::cancelled, "The job was stopped; send it again to have it done.");
}

void tell_stage(const RunningJob& job, StageClock& clock, const StageEvent& stage) {
  clock.enter(stage.stage);
  job.feed->set_progress({.stage = stage.stage,
                          .fraction = stage.fraction,
                          .chart = stage.chart,
                          .iteration = 0,
                          .energy = 0});
  job.feed->publish([&](std::int64_t seq) { return api::stage_event(seq, stage); });
}

void tell_iteration(const RunningJob& job, const StageClock& clock, const IterationEvent& event) {
  job.feed->set_progress({.stage = Stage::solve,
                          .fraction = event.fraction,
                          .chart = event.chart,
                          .iteration = event.iteration,
                          .energy = event.energy});
  job.feed->publish(
      [&](std::int64_t seq) { return api::iteration_event(seq, event, clock.elapsed_ms()); });
}

Progress progress_of(const RunningJob& job, StageClock& clock) {
  return {.on_stage = [&](const StageEvent& stage) { tell_stage(job, clock, stage); },
          .on_iteration =
              [&](const IterationEvent& iteration) { tell_iteration(job, clock, iteration); },
          .stop = job.stop.get_token()};
}

asset::Format output_format(api::OutputFormat wanted, asset::Format came_as) {
  switch (wanted) {
    case api::OutputFormat::automatic:
      return came_as;
    case api::OutputFormat::glb:
      return asset::Format::glb;
    case api::OutputFormat::gltf:
      return asset::Format::gltf;
    case api::OutputFormat::obj:
      return asset::Format::obj;
  }
  return came_as;
}

api::ReportContext context_of(const RunningJob& job, StageClock& clock) {
  const auto queue_ms = static_cast<double>(job.started_ms - job.record.created_ms);
  return {.sha256 = job.record.input.sha256,
          .bytes = job.record.input.bytes,
          .version = UNWRAPD_VERSION,
          .timings_ms = clock.timings_ms(std::max(0.0, queue_ms)),
          .notes = job.record.notes};
}

/// What every map of a job needs to be answered with: the rest is made when somebody asks.
void write_maps(const RunningJob& job, BlobStore& blobs, const std::vector<Unwrapped>& maps,
                StageClock& clock) {
  const std::string& id = job.record.id;
  for (std::size_t map = 0; map < maps.size(); ++map)
    blobs.write(id, map_file(kUvFile, map), encode_uvs(maps[map].surfaces));
  check_stop(job);
  blobs.write(id, kTotalsFile, api::totals_json(maps.front().report).dump());
  const api::ReportContext context = context_of(job, clock);
  for (std::size_t map = 0; map < maps.size(); ++map)
    blobs.write(id, map_file(kReportFile, map), api::to_json(maps[map].report, context).dump());
}

}  // namespace

asset::ReadLimits read_limits(const JobRecord& job, const api::Limits& limits) {
  const std::int64_t faces = job.synchronous ? limits.max_sync_faces : limits.max_faces;
  return {.max_vertices = limits.max_vertices, .max_faces = std::min(faces, limits.max_faces)};
}

std::string run_job(const RunningJob& job, BlobStore& blobs, const api::Limits& limits,
                    Executor& executor) {
  const JobRecord& record = job.record;
  StageClock clock(job.began);
  const Progress progress = progress_of(job, clock);
  progress.on_stage({.stage = Stage::read, .chart = 0, .chart_count = 0, .fraction = 0});
  const LoadedInput loaded(blobs, record);
  const asset::Asset asset = asset::read(loaded.input(), read_limits(record, limits));
  check_stop(job);

  const api::JobOptions options = api::parse_options(record.options, limits);
  const std::vector<Unwrapped> maps =
      unwrap_curve(asset.surfaces(), options.unwrap, progress, executor);

  progress.on_stage(
      {.stage = Stage::write, .chart = 0, .chart_count = 0, .fraction = kWriteFraction});
  const asset::Format format = output_format(options.output, asset.format());
  std::string name(format_name(format));
  const std::vector<UnwrappedSurface>& first = maps.front().surfaces;
  write_result(blobs, record.id, name, asset::write(asset, first, format));
  blobs.write(record.id, kLayoutFile, layout_svg(asset.surfaces(), first));
  write_maps(job, blobs, maps, clock);
  return name;
}

}  // namespace unwrapd::server
