#include "client/run.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>
#include <vector>

#include "api/options.hpp"
#include "client/files.hpp"
#include "client/gltf_buffers.hpp"
#include "client/input_file.hpp"
#include "client/outputs.hpp"
#include "client/sample.hpp"
#include "client/workplace.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

/// Short options go into the query; lists of objects, and files beside the mesh, need a multipart
/// request.
api::Job submit(JobClient& client, const Arguments& arguments, const fs::path& file) {
  const auto textures = arguments.options.find("textures");
  const bool with_images = textures != arguments.options.end() && textures->second == "transfer";
  const auto buffers = external_buffers(file, with_images);
  const bool is_long = std::ranges::any_of(arguments.options, [](const auto& option) {
    return api::find_option(option.first)->type == api::OptionType::objects;
  });
  if (buffers.empty() && !is_long) return client.submit(raw_upload(file), arguments.options);
  const api::Query given(arguments.options.begin(), arguments.options.end());
  const std::string options = api::options_object(given).dump();
  return client.submit(multipart_upload(options, file, buffers), {});
}

api::Job follow(JobClient& client, const std::string& job_id, const Console& console) {
  ProgressView view(console.err, console.style, console.width);
  ProgressState state;
  return client.follow(job_id, [&](const SseEvent& event) {
    state = advance(state, event.name, api::Json::parse(event.data, nullptr, false));
    view.show(state, ProgressView::Clock::now());
  });
}

/// Cancels the job of a stopped client, by another client, and returns the outcome as text.
std::string cancel(const ServerUrl& server, const std::string& job_id) {
  try {
    JobClient(server, {}).cancel(job_id);
    return "Stopped; the job " + job_id + " is cancelled.";
  } catch (const Failure& failure) {
    return "Stopped; the job " + job_id + " could not be cancelled: " + failure.what();
  }
}

/// Follows the job to its end, or cancels it if the wait ends before.
void finish_job(JobClient& client, const ServerUrl& server, const std::string& job_id,
                const Console& console) {
  try {
    const api::Job job = follow(client, job_id, console);
    if (job.state == api::JobState::succeeded) return;
    throw Failure(ExitCode::job_failed, job.problem.is_object()
                                            ? problem_text(job.problem)
                                            : "The job was cancelled by someone else.");
  } catch (const Failure& failure) {
    if (failure.code() != ExitCode::interrupted) throw;
    throw Failure(ExitCode::interrupted, cancel(server, job_id));
  }
}

/// "2 overlaps"; overlaps that were not counted are told as such.
std::string overlaps_text(const api::Json& report) {
  const api::Json& overlaps = report.at("overlaps");
  if (overlaps.is_null()) return "overlaps not counted";
  return std::to_string(overlaps.get<long>()) + " overlaps";
}

/// "chair.uv.glb: 20164 faces, 3 charts, D_angle 2.002, D_area 2.002, 0 flipped, 0 overlaps, fill
/// 0.71".
std::string summary(const std::string& name, const api::Json& report) {
  const api::Json& distortion = report.at("distortion");
  const std::size_t charts = report.at("charts").size();
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(),
                ": %ld faces, %zu chart%s, D_angle %.3f, D_area %.3f, %ld flipped, %s, fill %.2f\n",
                report.at("input").at("faces").get<long>(), charts, charts == 1 ? "" : "s",
                distortion.at("angle").get<double>(), distortion.at("area").get<double>(),
                distortion.at("flipped").get<long>(), overlaps_text(report).c_str(),
                report.at("fill").get<double>());
  return name + text.data();
}

/// Prints a line for each map, then the notes, which are the same for all.
void tell_maps(const std::vector<WrittenMap>& maps, std::ostream& out) {
  try {
    for (const WrittenMap& map : maps) out << summary(map.result, api::Json::parse(map.report));
    const api::Json report = api::Json::parse(maps.front().report);
    for (const api::Json& note : report.at("notes"))
      out << "note (" << note.at("code").get<std::string>()
          << "): " << note.at("text").get<std::string>() << "\n";
    out << std::flush;
  } catch (const api::Json::exception&) {
    throw Failure(ExitCode::unreachable,
                  "The report is not of this version; use a server of the same version as unwrap.");
  }
}

void tell(const Arguments& arguments, const std::vector<WrittenMap>& maps, const Console& console) {
  if (arguments.json) {
    console.out << maps.front().report << std::endl;
  } else if (!arguments.quiet) {
    tell_maps(maps, writes_to_standard_output(arguments) ? console.err : console.out);
  }
}

}  // namespace

void run(const Arguments& arguments, const Console& console, const std::stop_token& stop) {
  if (!arguments.sample.empty()) {
    write_file(arguments.sample, sample_glb());
    return;
  }
  check_outputs(arguments);
  const InputFile input(arguments.file, stop);
  Outputs outputs(arguments);
  const Workplace workplace(arguments, stop);
  if (workplace.is_here() && arguments.place == Place::any && !arguments.quiet)
    console.err << "No server answers at " << arguments.server.origin
                << ": the job runs in this process." << std::endl;
  JobClient client(workplace.server(), stop);
  const api::Job job = submit(client, arguments, input.path());
  finish_job(client, workplace.server(), job.id, console);
  tell(arguments, outputs.fill(client, job.id), console);
}

}  // namespace unwrapd::client
