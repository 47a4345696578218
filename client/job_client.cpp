#include "client/job_client.hpp"

#include <algorithm>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <optional>

#include "api/error_table.hpp"
#include "client/failure.hpp"

namespace unwrapd::client {
namespace {

using std::chrono::milliseconds;

constexpr int kTooManyRequests = 429;
constexpr int kUnavailable = 503;
constexpr long kLongestRetryAfterSeconds = 60;

std::string percent_encoded(const std::string& text) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       c == '-' || c == '.' || c == '_' || c == '~';
    encoded += plain ? std::string(1, c) : std::string{'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return encoded;
}

std::string query_of(const OptionTexts& options) {
  std::string query;
  for (const auto& [name, value] : options)
    query += (query.empty() ? "?" : "&") + percent_encoded(name) + "=" + percent_encoded(value);
  return query;
}

bool is_busy(const Reply& reply) {
  return reply.status == kTooManyRequests || reply.status == kUnavailable;
}

milliseconds retry_after(const Reply& reply) {
  const long seconds = std::strtol(reply.header("retry-after").c_str(), nullptr, 10);
  return std::chrono::seconds(std::clamp(seconds, 1L, kLongestRetryAfterSeconds));
}

/// JSON of an answer; null when it is none.
api::Json json_of(const std::string& body) {
  api::Json json = api::Json::parse(body, nullptr, false);
  return json.is_discarded() ? api::Json() : json;
}

[[noreturn]] void refuse(const Reply& reply) {
  const api::Json problem = json_of(reply.body);
  if (!problem.is_object() || !problem.contains("code"))
    throw Failure(ExitCode::unreachable, "The server answered with status " +
                                             std::to_string(reply.status) +
                                             ", but not as unwrapd does; check the address.");
  throw Failure(ExitCode::job_failed, problem_text(problem));
}

api::Job job_of(const api::Json& json) {
  try {
    return api::job_from_json(json);
  } catch (const Error& error) {
    throw Failure(ExitCode::unreachable, error.what());
  }
}

bool is_final_event(const SseEvent& event) {
  const auto state = api::state_named(event.name);
  return state && api::is_final(*state);
}

}  // namespace

JobClient::JobClient(ServerUrl server, std::stop_token stop, Patience patience)
    : http_(std::move(server), stop), stop_(std::move(stop)), patience_(patience) {}

api::Job JobClient::submit(const Upload& upload, const OptionTexts& options) {
  const std::string path = "/v1/jobs" + query_of(options);
  const Headers headers = {{"Accept", "application/json"}};
  Reply reply = http_.post(path, upload, headers);
  for (int refusal = 1; is_busy(reply) && refusal < patience_.refusals; ++refusal) {
    pause(retry_after(reply));
    reply = http_.post(path, upload, headers);
  }
  if (!reply.ok()) refuse(reply);
  return job_of(json_of(reply.body));
}

api::Job JobClient::follow(const std::string& job_id, const EventSink& on_event) {
  std::string last_id;
  std::optional<api::Job> job;
  int lost = 0;
  milliseconds wait = patience_.first_pause;
  const auto take = [&](const SseEvent& event) {
    last_id = event.id;
    lost = 0;
    wait = patience_.first_pause;
    if (is_final_event(event)) job = job_of(json_of(event.data));
    on_event(event);
  };
  while (true) {
    try {
      SseParser parser;
      Headers headers = {{"Accept", "text/event-stream"}};
      if (!last_id.empty()) headers["Last-Event-ID"] = last_id;
      const Reply reply = http_.get(api::job_path(job_id) + "/events", headers,
                                    [&](std::string_view bytes) { parser.feed(bytes, take); });
      if (job) return *job;
      if (!reply.ok() && !is_busy(reply)) refuse(reply);
      api::Job now = state_of(job_id);  // no stream to be had, or it ended early
      if (api::is_final(now.state)) return now;
      lost = 0;
    } catch (const Failure& failure) {
      if (job) return *job;
      if (failure.code() != ExitCode::unreachable || ++lost >= patience_.lost_connections) throw;
    }
    pause(wait);
    wait = std::min(2 * wait, patience_.longest_pause);
  }
}

std::string JobClient::fetch(const std::string& job_id, const std::string& what) {
  std::string body;
  fetch(job_id, what, [&](std::string_view bytes) { body += bytes; });
  return body;
}

void JobClient::fetch(const std::string& job_id, const std::string& what, const BytesSink& sink) {
  const Reply reply = http_.get(api::job_path(job_id) + what, {}, sink);
  if (!reply.ok()) refuse(reply);
}

void JobClient::cancel(const std::string& job_id) {
  const Reply reply = http_.remove(api::job_path(job_id));
  if (!reply.ok()) refuse(reply);
}

api::Job JobClient::state_of(const std::string& job_id) {
  const Reply reply = http_.get(api::job_path(job_id));
  if (!reply.ok()) refuse(reply);
  return job_of(json_of(reply.body));
}

void JobClient::pause(milliseconds duration) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any never_notified;  // but by the stop token
  never_notified.wait_for(lock, stop_, duration, [] { return false; });
  if (stop_.stop_requested()) throw Failure(ExitCode::interrupted, "Stopped.");
}

std::string problem_text(const api::Json& problem) {
  const auto member = [&](const char* name) {
    const auto found = problem.find(name);
    return found != problem.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  std::string text = member("title") + ": " + member("detail") + " (code " + member("code");
  if (!member("pointer").empty()) text += ", at " + member("pointer");
  return text + ")";
}

}  // namespace unwrapd::client
