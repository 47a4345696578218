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

/// succeeded, failed or cancelled: the job does not change any more.
bool is_final(JobState state);

std::string_view stage_name(Stage stage);
std::optional<Stage> stage_named(std::string_view name);

/// The progress of a running job.
struct JobProgress {
  Stage stage = Stage::read;
  double fraction = 0;  ///< of the whole job, [0, 1]
  Index chart = 0;
  int iteration = 0;
  double energy = 0;
};

struct Job {
  std::string id = {};
  std::string name = {};  ///< for people; empty without one
  JobState state = JobState::queued;
  std::string created = {};             ///< RFC 3339, UTC
  std::string finished = {};            ///< the same; empty until the job is final
  std::optional<double> duration = {};  ///< seconds between both, waiting included
  int attempt = 0;                      ///< number of times that a worker has started it
  Json options = Json::object();
  std::optional<JobProgress> progress = {};  ///< set while it runs
  Json problem = nullptr;                    ///< null unless failed or cancelled
  Json links = nullptr;                      ///< null: job_links() of its id
};

/// The path of a job: "/v1/jobs/" + id.
std::string job_path(std::string_view id);

/// {self, events, result, report, layout, ...}: the paths of a job's resources, by name.
Json job_links(std::string_view id);

/// With links, and with progress and problem if they are set.
Json to_json(const JobProgress& progress);
/// Throws Error{malformed_request} or Json::exception for what to_json() has not made.
JobProgress progress_of(const Json& json);
Json to_json(const Job& job);

/// Reads the output of to_json(). Members that this version does not know are ignored. Throws
/// Error{malformed_request} if a member is missing or of another type.
Job job_from_json(const Json& json);

}  // namespace unwrapd::api
