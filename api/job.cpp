#include "api/job.hpp"

#include <algorithm>
#include <array>

#include "core/base/error.hpp"

namespace unwrapd::api {
namespace {

// Each in the order of its enumerators.
constexpr std::array<std::string_view, 5> kStates = {"queued", "running", "succeeded", "failed",
                                                     "cancelled"};
constexpr std::array<std::string_view, 10> kStages = {
    "read", "setup", "segment", "merge", "factor", "solve", "untangle", "measure", "pack", "write"};

template <class Enum>
std::optional<Enum> find_enumerator(std::span<const std::string_view> names,
                                    std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Enum>(found - names.begin());
}

template <class T>
T require_known(const std::optional<T>& value) {
  if (!value)
    throw Error(ErrorCode::malformed_request, "The state of the job is unknown to this version.");
  return *value;
}

Job read_job(const Json& json) {
  Job job{.id = json.at("id").get<std::string>(),
          .name = json.value("name", ""),
          .state = require_known(state_named(json.at("state").get<std::string>())),
          .created = json.at("created").get<std::string>(),
          .attempt = json.at("attempt").get<int>(),
          .options = json.at("options"),
          .progress = {},
          .problem = {}};
  job.finished = json.value("finished", "");
  if (json.contains("duration")) job.duration = json.at("duration").get<double>();
  if (json.contains("progress")) job.progress = progress_of(json.at("progress"));
  if (json.contains("problem")) job.problem = json.at("problem");
  return job;
}

}  // namespace

Json to_json(const JobProgress& progress) {
  return {{"stage", stage_name(progress.stage)},
          {"fraction", finite(progress.fraction)},
          {"chart", progress.chart},
          {"iteration", progress.iteration},
          {"energy", finite(progress.energy)}};
}

JobProgress progress_of(const Json& json) {
  return {.stage = require_known(stage_named(json.at("stage").get<std::string>())),
          .fraction = json.at("fraction").get<double>(),
          .chart = json.at("chart").get<Index>(),
          .iteration = json.at("iteration").get<int>(),
          .energy = json.at("energy").get<double>()};
}

std::string_view state_name(JobState state) { return kStates[static_cast<std::size_t>(state)]; }

std::optional<JobState> state_named(std::string_view name) {
  return find_enumerator<JobState>(kStates, name);
}

bool is_final(JobState state) { return state != JobState::queued && state != JobState::running; }

std::string_view stage_name(Stage stage) { return kStages[static_cast<std::size_t>(stage)]; }

std::optional<Stage> stage_named(std::string_view name) {
  return find_enumerator<Stage>(kStages, name);
}

std::string job_path(std::string_view id) { return "/v1/jobs/" + std::string(id); }

Json job_links(std::string_view id) {
  const std::string self = job_path(id);
  return {{"self", self},
          {"events", self + "/events"},
          {"result", self + "/result"},
          {"report", self + "/report"},
          {"layout", self + "/layout.svg"},
          {"layout_png", self + "/layout.png"},
          {"preview", self + "/preview.png"}};
}

Json to_json(const Job& job) {
  Json json = {{"id", job.id}};
  if (!job.name.empty()) json["name"] = job.name;
  json["state"] = state_name(job.state);
  json["created"] = job.created;
  if (!job.finished.empty()) json["finished"] = job.finished;
  if (job.duration) json["duration"] = *job.duration;
  json["attempt"] = job.attempt;
  json["options"] = job.options;
  if (job.progress) json["progress"] = to_json(*job.progress);
  if (!job.problem.is_null()) json["problem"] = job.problem;
  json["links"] = job.links.is_null() ? job_links(job.id) : job.links;
  return json;
}

Job job_from_json(const Json& json) {
  try {
    return read_job(json);
  } catch (const Json::exception&) {
    throw Error(
        ErrorCode::malformed_request,
        "The answer is not a job; check that an unwrapd of this version runs at this address.");
  }
}

}  // namespace unwrapd::api
