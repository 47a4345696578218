#include "client/unwrap_file.hpp"

#include <algorithm>

#include "api/options.hpp"
#include "client/files.hpp"
#include "client/input_file.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

constexpr Patience kShort{.lost_connections = 3, .refusals = 3};  // of a command that was stopped

/// The name and short options go into the query; lists of objects, and files beside the mesh, need
/// a multipart request.
api::Job submit(JobClient& client, const Arguments& arguments, const fs::path& file) {
  const auto files = files_beside(file, wanted_files(arguments));
  const bool is_long = std::ranges::any_of(arguments.options, [](const auto& option) {
    return api::find_option(option.first)->type == api::OptionType::objects;
  });
  OptionTexts query;
  if (!arguments.name.empty()) query["name"] = arguments.name;
  if (files.empty() && !is_long) {
    query.insert(arguments.options.begin(), arguments.options.end());
    return client.submit(raw_upload(file), query);
  }
  const api::Query given(arguments.options.begin(), arguments.options.end());
  const std::string options = api::options_object(given).dump();
  return client.submit(multipart_upload(options, file, files), query);
}

/// The server reads the mesh.
api::Job submit_address(JobClient& client, const Arguments& arguments) {
  const api::Query given(arguments.options.begin(), arguments.options.end());
  api::Json asked = {{"source", arguments.file.native()}, {"options", api::options_object(given)}};
  if (!arguments.name.empty()) asked["name"] = arguments.name;
  return client.submit(json_upload(asked.dump()), {});
}

api::Job submit_file(JobClient& client, const Arguments& arguments, const std::stop_token& stop) {
  const InputFile input(arguments.file, stop);
  return submit(client, arguments, input.path());
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
std::string cancel(const Servers& servers, const std::string& job_id) {
  try {
    JobClient(servers, {}, kShort).cancel(job_id);
    return "Stopped; the job " + job_id + " is cancelled.";
  } catch (const Failure& failure) {
    return "Stopped; the job " + job_id + " could not be cancelled: " + failure.what();
  }
}

/// Follows the job to its end, or cancels it if the wait ends before.
void finish_job(JobClient& client, const std::string& job_id, const Console& console) {
  try {
    const api::Job job = follow(client, job_id, console);
    if (job.state == api::JobState::succeeded) return;
    throw Failure(ExitCode::job_failed, job.problem.is_object()
                                            ? problem_text(job.problem)
                                            : "The job was cancelled by someone else.");
  } catch (const Failure& failure) {
    if (failure.code() != ExitCode::interrupted) throw;
    throw Failure(ExitCode::interrupted, cancel(client.servers(), job_id));
  }
}

}  // namespace

WantedFiles wanted_files(const Arguments& arguments) {
  const auto given = [&](const char* name) {
    const auto option = arguments.options.find(name);
    return option == arguments.options.end() ? std::string() : option->second;
  };
  const std::string output = given("output");
  return {.images = given("textures") == "transfer" || output == "glb",
          .materials = output == "glb" || output == "gltf"};
}

std::string finished_job(JobClient& client, const Arguments& arguments, const Console& console,
                         const std::stop_token& stop) {
  const api::Job job = is_address(arguments.file) ? submit_address(client, arguments)
                                                  : submit_file(client, arguments, stop);
  finish_job(client, job.id, console);
  return job.id;
}

std::vector<WrittenMap> unwrap_file(JobClient& client, const Arguments& arguments,
                                    const Console& console, const std::stop_token& stop) {
  Outputs outputs(arguments);
  const std::string job = finished_job(client, arguments, console, stop);
  return outputs.fill(client, job);
}

}  // namespace unwrapd::client
