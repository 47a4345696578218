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
  constexpr const char* digits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       c == '-' || c == '.' || c == '_' || c == '~';
    encoded += plain ? std::string(1, c) : std::string{'%', digits[byte >> 4], digits[byte & 15]};
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

/// JSON of an answer; null if it is not JSON.
api::Json json_of(const std::string& body) {
  api::Json json = api::Json::parse(body, nullptr, false);
  return json.is_discarded() ? api::Json() : json;
}

[[noreturn]] void refuse(const Reply& reply) {
  const api::Json problem = json_of(reply.body);
  if (!problem.is_object() || !problem.contains("code"))
    throw Failure(ExitCode::unreachable,
                  "The server answered with status " + std::to_string(reply.status) +
                      ", but not like unwrapd; check the address, or use --local.");
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
  FollowState following{.last_id = {}, .job = {}, .wait = patience_.first_pause};
  while (true) {
    try {
      read_events(job_id, following, on_event);
    } catch (const Failure& failure) {
      if (!following.job && !may_reconnect(failure, following)) throw;
    }
    if (following.job) return *following.job;
    pause(following.wait);
    following.wait = std::min(2 * following.wait, patience_.longest_pause);
  }
}

bool JobClient::may_reconnect(const Failure& failure, FollowState& following) const {
  return failure.code() == ExitCode::unreachable && ++following.lost < patience_.lost_connections;
}

void JobClient::read_events(const std::string& job_id, FollowState& following,
                            const EventSink& on_event) {
  const auto take = [&](const SseEvent& event) {
    following.last_id = event.id;
    following.lost = 0;
    following.wait = patience_.first_pause;
    if (is_final_event(event)) following.job = job_of(json_of(event.data));
    on_event(event);
  };
  SseParser parser;
  Headers headers = {{"Accept", "text/event-stream"}};
  if (!following.last_id.empty()) headers["Last-Event-ID"] = following.last_id;
  const Reply reply = http_.get(api::job_path(job_id) + "/events", headers,
                                [&](std::string_view bytes) { parser.feed(bytes, take); });
  if (following.job) return;
  if (!reply.ok() && !is_busy(reply)) refuse(reply);
  const api::Job now = state_of(job_id);  // no stream is available, or it ended early
  following.lost = 0;
  if (api::is_final(now.state)) following.job = now;
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
  std::condition_variable_any never_notified;  // only the stop token ends the wait
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
