#include "server/routes/job_list.hpp"

#include "server/http/query.hpp"

namespace unwrapd::server::routes {
namespace {

constexpr int kMaxLimit = 200;

void set_filter(store::JobFilter& filter, const std::string& name, const std::string& text) {
  if (name == "state") {
    filter.state = api::state_named(text);
    if (!filter.state)
      http::refuse_parameter(name, "There is no such state of jobs; see /openapi.yaml.");
  } else if (name == "limit") {
    filter.limit = static_cast<int>(http::positive_number(name, text, kMaxLimit));
  } else if (name == "cursor") {
    filter.before_seq = http::positive_number(name, text, std::int64_t{1} << 53);
  } else {
    http::refuse_unknown(name);
  }
}

}  // namespace

http::Response list_jobs(store::JobStore& store, const http::Request& request) {
  store::JobFilter filter;
  if (!request.caller.sees_all) filter.owner = request.caller.owner;
  for (const auto& [name, text] : request.query) {
    http::check_once(request, name);
    set_filter(filter, name, text);
  }
  const int limit = filter.limit++;  // one more tells whether another page follows
  std::vector<store::JobRecord> jobs = store.list(filter);
  const bool more = jobs.size() > static_cast<std::size_t>(limit);
  if (more) jobs.resize(static_cast<std::size_t>(limit));
  api::Json page = {{"jobs", api::Json::array()}, {"next", nullptr}};
  for (const store::JobRecord& job : jobs) page["jobs"].push_back(api::to_json(store::to_job(job)));
  if (more) page["next"] = std::to_string(jobs.back().seq);
  http::Response response = http::json_response(200, page.dump());
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

}  // namespace unwrapd::server::routes
