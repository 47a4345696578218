#pragma once
// A job as its owner sees it, to and from JSON.

#include <optional>
#include <string>
#include <string_view>

#include "api/json.hpp"
#include "core/types/progress.hpp"

namespace unwrapd::api {

enum class JobState { queued, running, succeeded, failed, cancelled };

std::string_view state_name(JobState state);
std::optional<JobState> state_named(std::string_view name);

/// succeeded, failed or cancelled: nothing will change any more.
bool is_final(JobState state);

std::string_view stage_name(Stage stage);
std::optional<Stage> stage_named(std::string_view name);

/// How far a running job is.
struct JobProgress {
  Stage stage = Stage::read;
  double fraction = 0;  ///< of the whole job, [0, 1]
  Index chart = 0;
  int iteration = 0;
  double energy = 0;
};

struct Job {
  std::string id = {};
  JobState state = JobState::queued;
  std::string created = {};  ///< RFC 3339, UTC
  int attempt = 0;           ///< how often a worker has begun it
  Json options = Json::object();
  std::optional<JobProgress> progress = {};  ///< once it runs
  Json problem = nullptr;                    ///< null unless failed or cancelled
};

/// The path of a job: "/v1/jobs/" + id.
std::string job_path(std::string_view id);

/// With links{self, events, result, report, layout}; progress and problem only where there are any.
Json to_json(const Job& job);

/// The job that to_json() wrote; members that this version does not know are passed over. Throws
/// Error{malformed_request} when a member is missing or of another type.
Job job_from_json(const Json& json);

}  // namespace unwrapd::api
