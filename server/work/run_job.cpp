#include "server/work/run_job.hpp"

#include <algorithm>
#include <array>

#include "api/options.hpp"
#include "api/report.hpp"
#include "core/base/shared_cache.hpp"
#include "core/unwrap.hpp"
#include "server/base/errors.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/store/stored_input.hpp"
#include "server/work/lambda_selection.hpp"
#include "server/work/stage_timer.hpp"
#include "server/work/uv_file.hpp"

namespace unwrapd::server::work {
namespace {

constexpr double kWriteFraction = 0.95;  // of the job is done when writing begins

void check_stop(const JobTask& task) {
  if (task.stop.stop_requested()) throw job_stopped();
}

Progress progress_of(const JobTask& task, JobOutput& output, StageTimer& clock) {
  return {.on_stage =
              [&](const StageEvent& event) {
                clock.enter(event.stage);
                output.stage(event);
              },
          .on_iteration =
              [&](const IterationEvent& event) { output.iteration(event, clock.elapsed_ms()); },
          .stop = task.stop};
}

asset::Format output_format(api::OutputFormat wanted, asset::Format came_as) {
  switch (wanted) {
    case api::OutputFormat::automatic:
      break;
    case api::OutputFormat::glb:
      return asset::Format::glb;
    case api::OutputFormat::gltf:
      return asset::Format::gltf;
    case api::OutputFormat::obj:
      return asset::Format::obj;
  }
  return asset::usual_output(came_as);
}

/// Without what follows from a map.
api::ReportContext context_of(const JobTask& task, StageTimer& clock) {
  api::ReportContext context{.sha256 = task.record.input.sha256,
                             .bytes = task.record.input.bytes,
                             .version = UNWRAPD_VERSION,
                             .timings_ms = clock.timings_ms(task.queue_ms),
                             .options = store::without_long_members(task.record.options)};
  for (const std::string& note : task.record.notes)
    context.notes.push_back({NoteCode::option_unused, note});
  return context;
}

/// The results of a job.
struct Made {
  const asset::Asset& asset;
  asset::Format format;
  const std::vector<Unwrapped>& maps;
};

/// Adds what writing the asset with this map adds to the report.
api::ReportContext completed(api::ReportContext context, const Made& made, const Unwrapped& map,
                             bool with_vertex_maps) {
  for (Note& note : asset::side_effects(made.asset, map.surfaces, made.format))
    context.notes.push_back(std::move(note));
  context.file_repairs.assign(made.asset.repairs().begin(), made.asset.repairs().end());
  context.texcoord = made.asset.texcoord(made.format);
  if (with_vertex_maps)
    context.vertex_maps = asset::vertex_maps(made.asset, map.surfaces, made.format);
  return context;
}

/// The files of each map of a job; all others are made on request.
void write_maps(const JobTask& task, JobOutput& output, const Made& made, StageTimer& clock,
                bool with_vertex_maps) {
  const std::vector<Unwrapped>& maps = made.maps;
  for (std::size_t map = 0; map < maps.size(); ++map)
    output.file(map_file(blobs::kUvFile, map), encode_uvs(maps[map].surfaces));
  check_stop(task);
  const api::ReportContext context = context_of(task, clock);
  for (std::size_t map = 0; map < maps.size(); ++map) {
    const api::ReportContext own = completed(context, made, maps[map], with_vertex_maps);
    if (map == 0) {
      for (const Note& note : maps[map].report.notes) output.note(note);
      for (const Note& note : own.notes) output.note(note);
      output.file(blobs::kTotalsFile, api::totals_json(maps[map].report, own).dump());
    }
    output.file(map_file(blobs::kReportFile, map), api::to_json(maps[map].report, own).dump());
  }
}

}  // namespace

asset::ReadLimits read_limits(const store::JobRecord& job, const api::Limits& limits,
                              std::size_t memory_bytes) {
  const std::int64_t faces = job.synchronous ? limits.max_sync_faces : limits.max_faces;
  return {.max_vertices = limits.max_vertices,
          .max_faces = std::min(faces, limits.max_faces),
          .max_bytes = memory_bytes,
          .max_unzipped_bytes = static_cast<std::size_t>(limits.max_body_bytes)};
}

std::string run_job(const JobTask& task, const asset::Input& input, JobOutput& output,
                    const api::Limits& limits, Executor& executor) {
  const store::JobRecord& record = task.record;
  StageTimer clock(task.began);
  const Progress progress = progress_of(task, output, clock);
  progress.on_stage({.stage = Stage::read, .chart = 0, .chart_count = 0, .fraction = 0});
  const api::JobOptions options = api::parse_stored_options(record.options);
  asset::Input watched = input;
  watched.stop = task.stop;
  const SharedCache* core = executor.shared_cache();
  const std::size_t memory = core != nullptr ? core->memory_limit() : asset::kNoByteLimit;
  asset::Asset asset = asset::read(watched, read_limits(record, limits, memory), options.asset);
  if (options.unwrap.keeps_uvs() || options.unwrap.seams == SeamMode::uv0) asset::read_uvs(asset);
  if (options.unwrap.packing.group == PageGroup::material) asset::name_materials(asset);
  check_stop(task);

  const std::vector<Unwrapped> maps =
      unwrap_curve(asset.surfaces(), options.unwrap, progress, executor);

  progress.on_stage(
      {.stage = Stage::write, .chart = 0, .chart_count = 0, .fraction = kWriteFraction});
  const asset::Format format = output_format(options.output, asset.format());
  std::string name(asset::format_name(format));
  const std::vector<UnwrappedSurface>& first = maps.front().surfaces;
  output.result(name, asset::write(asset, first, format));
  write_maps(task, output, {asset, format, maps}, clock, options.asset.vertex_map);
  return name;
}

}  // namespace unwrapd::server::work
