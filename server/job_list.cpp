#include "server/job_list.hpp"

#include <charconv>

#include "api/options.hpp"

namespace unwrapd::server {
namespace {

constexpr int kMaxLimit = 200;

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::invalid_option, what, "/" + name);
}

std::int64_t number_of(const std::string& name, const std::string& text, std::int64_t most) {
  std::int64_t number = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end || number < 1 || number > most)
    refuse(name, "The parameter " + name + " is a number from 1 to " + std::to_string(most) + ".");
  return number;
}

void set_filter(JobFilter& filter, const std::string& name, const std::string& text) {
  if (name == "state") {
    filter.state = api::state_named(text);
    if (!filter.state) refuse(name, "There is no such state of jobs; see /openapi.yaml.");
  } else if (name == "limit") {
    filter.limit = static_cast<int>(number_of(name, text, kMaxLimit));
  } else if (name == "cursor") {
    filter.before_seq = number_of(name, text, std::int64_t{1} << 53);
  } else {
    refuse(name, "There is no parameter of this name here; see /openapi.yaml.");
  }
}

}  // namespace

Response list_jobs(JobStore& store, const Request& request) {
  JobFilter filter;
  if (!request.caller.sees_all) filter.owner = request.caller.owner;
  for (const auto& [name, text] : request.query) {
    if (request.query.count(name) > 1) refuse(name, "The parameter is given twice; give it once.");
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
