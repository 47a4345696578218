#include "server/routes/job_routes.hpp"

#include <algorithm>
#include <chrono>

#include "server/base/errors.hpp"
#include "server/http/media_types.hpp"
#include "server/http/query.hpp"
#include "server/routes/link_routes.hpp"
#include "server/routes/result_routes.hpp"
#include "server/uploads/job_name.hpp"
#include "server/work/lambda_selection.hpp"

namespace unwrapd::server::routes {
namespace {

constexpr int kRetryAfterSeconds = 5;

/// The job as the caller may open it: with signed links by a ticket.
api::Job shown_job(const JobServices& services, const store::JobRecord& record,
                   const http::Request& request) {
  api::Job job = store::to_job(record);
  if (request.ticket) job.links = signed_links(services.links, job.id, request.caller);
  return job;
}

/// The job with its live progress.
http::Response job_response(int status, const JobServices& services, const store::JobRecord& record,
                            const http::Request& request) {
  api::Job job = shown_job(services, record, request);
  const bool is_running = record.state == api::JobState::running;
  const auto feed = is_running ? services.events.find_or_follow(record) : nullptr;
  if (feed) job.progress = feed->progress();
  return http::uncached_json_response(status, api::to_json(job).dump());
}

/// Waits for the end of a job, at most so long.
void wait_for(const JobServices& services, const std::string& id, std::chrono::seconds time) {
  std::shared_ptr<jobs::JobFeed> feed = services.events.find(id);
  if (!feed)
    if (const auto job = services.store.find(id)) feed = services.events.find_or_follow(*job);
  if (feed) static_cast<void>(feed->wait_finished(std::chrono::steady_clock::now() + time));
}

/// The job that a call of the same request has made.
store::JobRecord stored_job(store::JobStore& store, const std::string& id) {
  std::optional<store::JobRecord> job = store.find(id);
  if (!job)
    throw Error(ErrorCode::not_found, "The job was removed in the meantime; send it again.");
  return std::move(*job);
}

/// Refuses a client without a place among the streams before its job is accepted.
http::Response post_watched(const JobServices& services, const http::Request& request) {
  Watcher watcher = services.streams.let_in(request);
  const std::string id = services.submissions.accept(request, false);
  const store::JobRecord job = stored_job(services.store, id);
  http::Response response =
      services.streams.open_accepted(job, shown_job(services, job, request), std::move(watcher));
  response.headers.emplace_back("Location", api::job_path(id));
  return response;
}

http::Response post_job(const JobServices& services, const http::Request& request) {
  if (http::prefers_events(request.header("Accept"))) return post_watched(services, request);
  const std::string id = services.submissions.accept(request, false);
  std::optional<int> wait = http::preferred_wait(request.header("Prefer"));
  const int seconds = std::min(wait.value_or(0), services.limits.max_wait_seconds);
  const auto place = seconds > 0 ? services.waiters.try_enter(request.caller.owner) : nullptr;
  if (!place && seconds > 0) wait.reset();  // a preference (RFC 7240), not a promise
  if (place) wait_for(services, id, std::chrono::seconds(seconds));
  const store::JobRecord job = stored_job(services.store, id);
  const bool finished = wait && api::is_final(job.state);
  http::Response response = job_response(finished ? 200 : 202, services, job, request);
  response.headers.emplace_back("Location", api::job_path(id));
  if (wait) response.headers.emplace_back("Preference-Applied", "wait=" + std::to_string(seconds));
  return response;
}

http::Response delete_job(const JobServices& services, const http::Request& request) {
  http::refuse_all(request);
  static_cast<void>(find_job(services.store, request));
  const bool was_live = services.queue.cancel_or_remove(request.id);
  if (was_live) return job_response(202, services, stored_job(services.store, request.id), request);
  http::Response response;
  response.status = 204;
  return response;
}

/// get_result() or get_json_result().
using GetResult = decltype(&get_result);

/// The answer to a synchronous call, once its job is final.
http::Response sync_response(const JobServices& services, const store::JobRecord& job,
                             const http::Request& request, GetResult result_of) {
  require_result(job);
  http::Response response = result_of(services.results, job, 0, request);
  response.headers.emplace_back("Unwrapd-Report", services.blobs.read(job.id, blobs::kTotalsFile));
  return response;
}

/// For a job to end after it was stopped at its time limit.
constexpr std::chrono::seconds kTimeToEnd{5};

/// Refuses a request for which no place to wait is free, before its body is read.
RetryLater too_many_wait() {
  return {ErrorCode::rate_limited,
          "Too many requests wait for their jobs; try again after Retry-After, or send the mesh to "
          "/v1/jobs, which does not wait.",
          kRetryAfterSeconds};
}

http::Response post_unwrap(const JobServices& services, const http::Request& request,
                           GetResult result_of) {
  const auto place = services.waiters.try_enter(request.caller.owner);
  if (!place) throw too_many_wait();
  const std::string id = services.submissions.accept(request, true);
  wait_for(services, id, std::chrono::seconds(services.limits.max_job_seconds) + kTimeToEnd);
  const store::JobRecord job = stored_job(services.store, id);
  http::Response response;
  try {
    response = answer_with_files(services.store, job, [&](const store::JobRecord& ended) {
      return sync_response(services, ended, request, result_of);
    });
  } catch (const Error& error) {
    response = http::error_response(error, id);
  }
  response.headers.emplace_back("Location", api::job_path(id));
  return response;
}

void add_files(std::vector<http::Route>& routes, const JobServices& services) {
  const auto add = [&](std::string_view path, auto answer) {
    routes.push_back(
        {"GET", path, [services, answer](const http::Request& request) {
           return answer_with_files(
               services.store, find_job(services.store, request), [&](const store::JobRecord& job) {
                 return answer(job, work::only_chosen_map(job, request.query), request);
               });
         }});
  };
  const auto add_result = [&](std::string_view path, GetResult result_of) {
    add(path, [services, result_of](const store::JobRecord& job, std::size_t map,
                                    const http::Request& request) {
      return result_of(services.results, job, map, request);
    });
  };
  add_result("/v1/jobs/{id}/result", &get_result_or_link);
  add_result("/v1/jobs/{id}/result.json", &get_json_result);
  add("/v1/jobs/{id}/report",
      [services](const store::JobRecord& job, std::size_t map, const http::Request&) {
        return get_file(services.blobs, job, work::map_file(blobs::kReportFile, map),
                        "application/json");
      });
}

constexpr int kMaxLimit = 200;

void set_filter(store::JobFilter& filter, const std::string& name, const std::string& text) {
  if (name == "state") {
    filter.state = api::state_named(text);
    if (!filter.state) refuse_option(name, "There is no such state of jobs; see /openapi.yaml.");
  } else if (name == "name") {
    filter.name = uploads::checked_job_name(text);
  } else if (name == "limit") {
    filter.limit = static_cast<int>(http::positive_number(name, text, kMaxLimit));
  } else if (name == "cursor") {
    filter.before_seq = http::positive_number(name, text, std::int64_t{1} << 53);
  } else {
    http::refuse_unknown(name);
  }
}

/// The caller's jobs, the newest first, in pages. Parameters: state, name, limit (1 to 200) and
/// cursor (the `next` of the page before). Throws Error{invalid_option} for a parameter that is
/// unknown, given twice or out of range.
http::Response list_jobs(store::JobStore& store, const http::Request& request) {
  store::JobFilter filter;
  if (!request.caller.sees_all) filter.owner = request.caller.owner;
  for (const auto& [name, text] : request.query) {
    http::check_once(request.query, name);
    set_filter(filter, name, text);
  }
  const int limit = filter.limit++;  // one more tells whether another page follows
  std::vector<store::JobRecord> jobs = store.list(filter);
  const bool more = jobs.size() > static_cast<std::size_t>(limit);
  if (more) jobs.resize(static_cast<std::size_t>(limit));
  api::Json page = {{"jobs", api::Json::array()}, {"next", nullptr}};
  for (const store::JobRecord& job : jobs) page["jobs"].push_back(api::to_json(store::to_job(job)));
  if (more) page["next"] = std::to_string(jobs.back().seq);
  return http::uncached_json_response(200, page.dump());
}

void add_submission_routes(std::vector<http::Route>& routes, const JobServices& services) {
  const auto add = [&](std::string_view method, std::string_view path, auto post) {
    routes.push_back({method, path, [services, post](const http::Request& request) {
                        return post(services, request);
                      }});
  };
  add("POST", "/v1/jobs", &post_job);
  add("PUT", "/v1/jobs/{id}", &post_job);
  add("POST", "/v1/meshes/{sha256}/jobs", &post_job);
  add("POST", "/v1/jobs/events", &post_watched);
  add("PUT", "/v1/jobs/{id}/events", &post_watched);
}

}  // namespace

store::JobRecord find_job(store::JobStore& store, const http::Request& request) {
  std::optional<store::JobRecord> job = store.find(request.id);
  const bool seen = job && (request.caller.sees_all || job->owner == request.caller.owner);
  if (!seen) throw unknown_job();
  return std::move(*job);
}

http::Response answer_with_files(
    store::JobStore& store, const store::JobRecord& job,
    const std::function<http::Response(const store::JobRecord& job)>& answer) {
  try {
    return answer(job);
  } catch (const Error& error) {
    const bool may_be_gone =
        error.code() == ErrorCode::storage_failed || error.code() == ErrorCode::storage_corrupt;
    if (may_be_gone) require_result(stored_job(store, job.id));
    throw;
  }
}

void add_job_routes(std::vector<http::Route>& routes, const JobServices& services) {
  const auto find = [services](const http::Request& request) {
    return find_job(services.store, request);
  };
  add_submission_routes(routes, services);
  routes.push_back({"GET", "/v1/jobs", [services](const http::Request& request) {
                      return list_jobs(services.store, request);
                    }});
  routes.push_back({"GET", "/v1/jobs/{id}", [services, find](const http::Request& request) {
                      http::refuse_all(request);
                      return job_response(200, services, find(request), request);
                    }});
  routes.push_back({"DELETE", "/v1/jobs/{id}", [services](const http::Request& request) {
                      return delete_job(services, request);
                    }});
  routes.push_back({"GET", "/v1/jobs/{id}/events", [services, find](const http::Request& request) {
                      http::refuse_all(request);
                      return services.streams.open(find(request), request);
                    }});
  add_files(routes, services);
}

void add_unwrap_route(std::vector<http::Route>& routes, const JobServices& services) {
  const auto add = [&](std::string_view path, GetResult result_of) {
    routes.push_back({"POST", path, [services, result_of](const http::Request& request) {
                        return post_unwrap(services, request, result_of);
                      }});
  };
  add("/v1/unwrap", &get_result);
  add("/v1/unwrap.json", &get_json_result);
}

}  // namespace unwrapd::server::routes
