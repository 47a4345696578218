#include "server/results/renderer.hpp"

#include <chrono>
#include <filesystem>
#include <future>
#include <stop_token>
#include <system_error>
#include <thread>

#include "server/base/threads.hpp"
#include "server/base/trace.hpp"
#include "server/store/stored_input.hpp"
#include "server/work/lambda_selection.hpp"

namespace unwrapd::server::results {
namespace {

/// Memory for making a file, per byte of the stored mesh and map: measured 5 to 8 for an OBJ of
/// 80,000 faces.
constexpr std::uintmax_t kBytesAByte = 8;

}  // namespace

std::shared_ptr<void> Renderer::enter(const store::JobRecord& job, const WantedFile& wanted) {
  std::error_code gone;  // then rendering reports it
  const std::uintmax_t uvs = std::filesystem::file_size(
      blobs_.path(job.id, work::map_file(blobs::kUvFile, wanted.map)), gone);
  const auto kept = static_cast<std::uintmax_t>(job.input.bytes) + (gone ? 0 : uvs);
  return room_.enter({.file = job.id + "/" + wanted.file,
                      .holder = job.owner.empty() ? job.id : job.owner,
                      .bytes = static_cast<std::size_t>(kBytesAByte * kept) + wanted.bytes,
                      .is_costly = wanted.is_costly},
                     wanted.has_left);
}

std::string Renderer::render(const store::JobRecord& job, const work::Rendering& rendering,
                             const http::HasLeft& has_left) const {
  const std::string uv_file = work::map_file(blobs::kUvFile, rendering.map);
  if (blobs_.holds(job.id) && !blobs_.has(job.id, uv_file) &&
      !std::filesystem::exists(blobs_.path(job.id, uv_file))) {
    throw Error(ErrorCode::result_expired,
                "An earlier version ran this job and stored no map, so it cannot be drawn or "
                "converted; send the job again.");
  }
  const store::LoadedInput loaded(blobs_, job);
  const std::string uvs = blobs_.read(job.id, uv_file);
  std::string report;
  const bool shows_pages =
      rendering.picture && rendering.picture->kind != work::PictureKind::preview_png;
  if (shows_pages || (!rendering.picture && !rendering.format))
    report = blobs_.read(job.id, work::map_file(blobs::kReportFile, rendering.map));
  return make(rendering,
              {.record = loaded.record(), .asset = loaded.input(), .uvs = uvs, .report = report},
              has_left);
}

std::string Renderer::analyse(const store::JobRecord& mesh, const http::HasLeft& has_left) const {
  const store::LoadedInput loaded(blobs_, mesh);
  return make({.map = 0, .picture = {}, .format = {}, .analysis = job_bytes_},
              {.record = loaded.record(), .asset = loaded.input(), .uvs = {}, .report = {}},
              has_left);
}

/// The calling thread waits, and checks whether the client is still connected.
std::string Renderer::make(const work::Rendering& rendering, work::RenderingInput input,
                           const http::HasLeft& has_left) const {
  std::stop_source stop;
  input.asset.stop = stop.get_token();
  std::packaged_task<std::string()> task([&, trace = current_trace()] {
    const TraceScope scope(trace);
    give_way();
    return make_here(rendering, input);
  });
  std::future<std::string> made = task.get_future();
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(limits_.max_job_seconds);
  bool left = false;
  const std::jthread maker([&task] { task(); });
  while (made.wait_for(kPresenceLook) != std::future_status::ready && !stop.stop_requested()) {
    left = has_left && has_left();
    if (left || std::chrono::steady_clock::now() >= end) stop.request_stop();
  }
  try {
    return made.get();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::time_limit && left) throw client_left();
    throw;
  }
}

std::string Renderer::make_here(const work::Rendering& rendering,
                                const work::RenderingInput& input) const {
  try {
    if (!isolation_.on) return functions_.draw(rendering, input, limits_);
    return work::render_isolated(rendering, input, input.asset.stop, limits_, isolation_);
  } catch (const work::WorkerCrashed& crash) {
    log_.warning("a worker process ended", {{"job", input.record.id}, {"how", crash.what()}});
    throw Error(ErrorCode::internal,
                "The process that made this file ended early; the stored result is unchanged.");
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) throw;
    throw Error(ErrorCode::time_limit, "Making this file took longer than the " +
                                           std::to_string(limits_.max_job_seconds) +
                                           " s allowed; request the result in its stored format.");
  }
}

}  // namespace unwrapd::server::results
