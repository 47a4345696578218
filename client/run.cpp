#include "client/run.hpp"

#include <array>
#include <cstdio>
#include <optional>
#include <ostream>

#include "api/options.hpp"
#include "client/files.hpp"
#include "client/gltf_buffers.hpp"
#include "client/sample.hpp"

namespace unwrapd::client {
namespace {

/// Options travel in the query as long as they are short; constraints and buffers need parts.
api::Job submit(JobClient& client, const Arguments& arguments) {
  const auto buffers = external_buffers(arguments.file);
  if (buffers.empty() && !arguments.options.contains("constraints"))
    return client.submit(raw_upload(arguments.file), arguments.options);
  const api::Query given(arguments.options.begin(), arguments.options.end());
  const std::string options = api::options_object(given).dump();
  return client.submit(multipart_upload(options, arguments.file, buffers), {});
}

api::Job follow(JobClient& client, const std::string& job_id, const Console& console) {
  ProgressView view(console.err, console.style, console.width);
  ProgressState state;
  return client.follow(job_id, [&](const SseEvent& event) {
    state = advance(state, event.name, api::Json::parse(event.data, nullptr, false));
    view.show(state, ProgressView::Clock::now());
  });
}

/// What became of a job whose client is stopped. The stopped client can send nothing any more.
std::string cancel(const Arguments& arguments, const std::string& job_id) {
  try {
    JobClient(arguments.server, {}).cancel(job_id);
    return "Stopped; the job " + job_id + " is cancelled.";
  } catch (const Failure& failure) {
    return "Stopped; the job " + job_id + " could not be cancelled: " + failure.what();
  }
}

/// Follows the job to its end. Whatever ends the waiting before, the job is not left behind.
void finish_job(JobClient& client, const Arguments& arguments, const std::string& job_id,
                const Console& console) {
  try {
    const api::Job job = follow(client, job_id, console);
    if (job.state == api::JobState::succeeded) return;
    throw Failure(ExitCode::job_failed, job.problem.is_object()
                                            ? problem_text(job.problem)
                                            : "The job was cancelled by someone else.");
  } catch (const Failure& failure) {
    if (failure.code() != ExitCode::interrupted) throw;
    throw Failure(ExitCode::interrupted, cancel(arguments, job_id));
  }
}

/// "chair.uv.glb: 20164 faces, 1 chart, D_angle 2.061, D_area 2.057, 0 flipped, fill 0.71".
std::string summary(const std::string& name, const api::Json& report) {
  const api::Json& distortion = report.at("distortion");
  const std::size_t charts = report.at("charts").size();
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(),
                ": %ld faces, %zu chart%s, D_angle %.3f, D_area %.3f, %ld flipped, fill %.2f\n",
                report.at("input").at("faces").get<long>(), charts, charts == 1 ? "" : "s",
                distortion.at("angle").get<double>(), distortion.at("area").get<double>(),
                distortion.at("flipped").get<long>(), report.at("fill").get<double>());
  return name + text.data();
}

void tell(const Arguments& arguments, const std::string& report_text, const Console& console) {
  if (arguments.json) {
    console.out << report_text << std::endl;
    return;
  }
  if (arguments.quiet) return;
  try {
    const api::Json report = api::Json::parse(report_text);
    console.out << summary(arguments.out.string(), report);
    for (const api::Json& note : report.at("notes"))
      console.out << "note: " << note.get<std::string>() << "\n";
    console.out << std::flush;
  } catch (const api::Json::exception&) {
    throw Failure(ExitCode::unreachable,
                  "The report is not of this version: is the server's version that of unwrap?");
  }
}

std::string layout_path(const Arguments& arguments) {
  std::string path = arguments.layout.extension() == ".png" ? "/layout.png" : "/layout.svg";
  if (!arguments.layout_colour.empty()) path += "?colour=" + arguments.layout_colour;
  return path;
}

/// The files to write, opened before anything is sent: what cannot be written is known at once.
class Outputs {
 public:
  explicit Outputs(const Arguments& arguments) : result_(arguments.out) {
    if (!arguments.report.empty()) report_.emplace(arguments.report);
    if (!arguments.layout.empty()) layout_.emplace(arguments.layout);
    if (!arguments.preview.empty()) preview_.emplace(arguments.preview);
    layout_path_ = layout_path(arguments);
  }

  /// Fetches and writes all of them, and returns the report.
  std::string fill(JobClient& client, const std::string& job_id) {
    client.fetch(job_id, "/result", [&](std::string_view bytes) { result_.append(bytes); });
    std::string report = client.fetch(job_id, "/report");
    if (report_) report_->append(report);
    if (layout_) layout_->append(client.fetch(job_id, layout_path_));
    if (preview_) preview_->append(client.fetch(job_id, "/preview.png"));
    if (report_) report_->commit();
    if (layout_) layout_->commit();
    if (preview_) preview_->commit();
    result_.commit();
    return report;
  }

 private:
  NewFile result_;
  std::optional<NewFile> report_, layout_, preview_;
  std::string layout_path_;
};

}  // namespace

void run(const Arguments& arguments, const Console& console, const std::stop_token& stop) {
  if (!arguments.sample.empty()) {
    write_file(arguments.sample, sample_glb());
    return;
  }
  file_bytes(arguments.file);
  Outputs outputs(arguments);
  JobClient client(arguments.server, stop);
  const api::Job job = submit(client, arguments);
  finish_job(client, arguments, job.id, console);
  tell(arguments, outputs.fill(client, job.id), console);
}

}  // namespace unwrapd::client
