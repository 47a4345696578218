#include "server/renderer.hpp"

#include <chrono>
#include <filesystem>
#include <stop_token>
#include <system_error>

#include "server/deadline.hpp"
#include "server/job_input.hpp"
#include "server/map_choice.hpp"

namespace unwrapd::server {
namespace {

/// Memory that a file takes while it is made, to what the job keeps on disk of its mesh and map:
/// measured 5 to 8 for an OBJ of 80,000 faces.
constexpr std::uintmax_t kBytesAByte = 8;

}  // namespace

std::shared_ptr<void> Renderer::enter(const JobRecord& job, std::size_t map,
                                      const std::string& file) {
  std::error_code gone;  // then there is nothing to make, and whoever tries will say so
  const std::uintmax_t uvs =
      std::filesystem::file_size(blobs_.path(job.id, map_file(kUvFile, map)), gone);
  const auto kept = static_cast<std::uintmax_t>(job.input.bytes) + (gone ? 0 : uvs);
  return room_.enter({.file = job.id + "/" + file,
                      .holder = job.owner.empty() ? job.id : job.owner,
                      .bytes = static_cast<std::size_t>(kBytesAByte * kept)});
}

std::string Renderer::render(const JobRecord& job, const Rendering& rendering) const {
  const std::string uv_file = map_file(kUvFile, rendering.map);
  if (blobs_.holds(job.id) && !blobs_.has(job.id, uv_file) &&
      !std::filesystem::exists(blobs_.path(job.id, uv_file))) {
    throw Error(ErrorCode::result_expired,
                "An earlier version did this job, and kept no map that could be drawn or written "
                "anew; send it again for that.");
  }
  const LoadedInput loaded(blobs_, job);
  const std::string uvs = blobs_.read(job.id, uv_file);
  std::string report;
  if (!rendering.picture && !rendering.format)
    report = blobs_.read(job.id, map_file(kReportFile, rendering.map));
  return make(rendering,
              {.record = loaded.record(), .asset = loaded.input(), .uvs = uvs, .report = report});
}

std::string Renderer::analyse(const JobRecord& mesh) const {
  const LoadedInput loaded(blobs_, mesh);
  return make({.map = 0, .picture = {}, .format = {}, .analysis = job_bytes_},
              {.record = loaded.record(), .asset = loaded.input(), .uvs = {}, .report = {}});
}

std::string Renderer::make(const Rendering& rendering, RenderingInput input) const {
  std::stop_source late;
  input.asset.stop = late.get_token();
  const Deadline deadline(std::chrono::seconds(limits_.max_job_seconds),
                          [&] { late.request_stop(); });
  try {
    if (!isolation_.on) return duties_.draw(rendering, input, limits_);
    return render_isolated(rendering, input, late.get_token(), limits_, isolation_);
  } catch (const WorkerCrashed& crash) {
    log_.warning("a worker process ended", {{"job", input.record.id}, {"how", crash.what()}});
    throw Error(ErrorCode::internal,
                "The process that made this file ended before it was done; what it was made from "
                "is as it was.");
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) throw;
    throw Error(ErrorCode::time_limit, "To make this file took longer than the " +
                                           std::to_string(limits_.max_job_seconds) +
                                           " s allowed; ask for the result as it was stored.");
  }
}

}  // namespace unwrapd::server
