#include "server/routes/job_list.hpp"

#include "server/http/query.hpp"

namespace unwrapd::server {
namespace {

constexpr int kMaxLimit = 200;

void set_filter(JobFilter& filter, const std::string& name, const std::string& text) {
  if (name == "state") {
    filter.state = api::state_named(text);
    if (!filter.state) refuse_parameter(name, "There is no such state of jobs; see /openapi.yaml.");
  } else if (name == "limit") {
    filter.limit = static_cast<int>(positive_number(name, text, kMaxLimit));
  } else if (name == "cursor") {
    filter.before_seq = positive_number(name, text, std::int64_t{1} << 53);
  } else {
    refuse_unknown(name);
  }
}

}  // namespace

Response list_jobs(JobStore& store, const Request& request) {
  JobFilter filter;
  if (!request.caller.sees_all) filter.owner = request.caller.owner;
  for (const auto& [name, text] : request.query) {
    check_once(request, name);
    set_filter(filter, name, text);
  }
  const int limit = filter.limit++;  // one more tells whether another page follows
  std::vector<JobRecord> jobs = store.list(filter);
  const bool more = jobs.size() > static_cast<std::size_t>(limit);
  if (more) jobs.resize(static_cast<std::size_t>(limit));
  api::Json page = {{"jobs", api::Json::array()}, {"next", nullptr}};
  for (const JobRecord& job : jobs) page["jobs"].push_back(api::to_json(to_job(job)));
  if (more) page["next"] = std::to_string(jobs.back().seq);
  Response response = json_response(200, page.dump());
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

}  // namespace unwrapd::server
