#include "client/job_client.hpp"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <random>
#include <utility>

#include "api/error_table.hpp"
#include "client/failure.hpp"

namespace unwrapd::client {
namespace {

using std::chrono::milliseconds;

constexpr int kTooManyRequests = 429;
constexpr int kServerError = 500;
constexpr int kOwnLosses = 20;  // in a row, while the same servers answer other calls
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

/// Up to a quarter more than is asked, so that many clients do not come back as one.
milliseconds retry_after(const Reply& reply) {
  const long asked = std::strtol(reply.header("retry-after").c_str(), nullptr, 10);
  const long seconds = std::clamp(asked, 1L, kLongestRetryAfterSeconds);
  thread_local std::minstd_rand random{std::random_device{}()};
  return milliseconds(std::uniform_int_distribution<long>(1000 * seconds, 1250 * seconds)(random));
}

/// A name that no other request has.
std::string new_idempotency_key() {
  std::random_device random;
  std::string key = "unwrap-";
  for (int k = 0; k < 4; ++k) {
    std::array<char, 9> digits;
    std::snprintf(digits.data(), digits.size(), "%08x", static_cast<unsigned>(random()));
    key += digits.data();
  }
  return key;
}

std::string title_of(const api::Json& problem) {
  return problem.is_object() && problem.contains("title") && problem["title"].is_string()
             ? problem["title"].get<std::string>()
             : "The server is busy.";
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

/// Lost connections in a row.
struct JobClient::Losses {
  int count = 0;
  std::chrono::steady_clock::time_point first = {};
};

/// The state of following a job across connections.
struct JobClient::FollowState {
  std::string last_id;
  std::optional<api::Job> job;  ///< set once it is final
  milliseconds pause;
  Losses losses = {};
  int refused = 0;  ///< in a row
  bool has_begun = false;
};

JobClient::JobClient(Servers servers, std::stop_token stop, Patience patience, Listener listener)
    : servers_(std::move(servers)),
      http_(servers_.next(), stop),
      stop_(std::move(stop)),
      patience_(patience),
      listener_(std::move(listener)) {}

Reply JobClient::ask_once(const Call& call) {
  Reply reply = call(http_);
  const bool is_of_server = reply.status < kServerError || reply.status == kUnavailable ||
                            json_of(reply.body).contains("code");
  if (!is_of_server)
    throw Failure(ExitCode::unreachable,
                  "What answered for the server at " + http_.server().origin +
                      " has a fault of its own (status " + std::to_string(reply.status) + ").",
                  true);
  servers_.note_answer(http_.server());
  return reply;
}

void JobClient::lose(const Failure& failure, Losses& losses) {
  if (!failure.may_pass()) throw failure;
  servers_.note_silence(http_.server());
  const int most =
      servers_.have_answered() ? patience_.lost_connections : static_cast<int>(servers_.size());
  if (losses.count == 0) losses.first = std::chrono::steady_clock::now();
  if (++losses.count >= most) throw failure;
  if (losses.count >= kOwnLosses && servers_.have_answered(losses.first))
    throw Failure(ExitCode::job_failed, failure.what());
  http_ = Http(servers_.next(), stop_);
}

Reply JobClient::ask(const Call& call) {
  milliseconds after_loss = patience_.first_pause;
  Losses losses;
  for (int refused = 0;;) {
    try {
      Reply reply = ask_once(call);
      losses = {};
      if (!is_busy(reply) || ++refused >= patience_.refusals) return reply;
      wait(title_of(json_of(reply.body)), retry_after(reply));
      after_loss = patience_.first_pause;
    } catch (const Failure& failure) {
      lose(failure, losses);
      wait(failure.what(), after_loss);
      after_loss = std::min(2 * after_loss, patience_.longest_pause);
    }
  }
}

api::Job JobClient::submit(const Upload& upload, const OptionTexts& options) {
  const std::string path = "/v1/jobs" + query_of(options);
  const Headers headers = {{"Accept", "application/json"},
                           {"Idempotency-Key", new_idempotency_key()}};
  const Reply reply = ask([&](const Http& http) { return http.post(path, upload, headers); });
  if (!reply.ok()) refuse(reply);
  return job_of(json_of(reply.body));
}

api::Job JobClient::follow(const std::string& job_id, const EventSink& on_event) {
  FollowState following{.last_id = {}, .job = {}, .pause = patience_.first_pause};
  while (true) {
    std::string why;
    try {
      read_events(job_id, following, on_event);
    } catch (const Failure& failure) {
      why = failure.what();
      if (!following.job) lose(failure, following.losses);
    }
    if (following.job) return *following.job;
    wait(why, following.pause);
    following.pause = std::min(2 * following.pause, patience_.longest_pause);
  }
}

void JobClient::note_begun(FollowState& following) const {
  if (!std::exchange(following.has_begun, true) && listener_.on_begun) listener_.on_begun();
}

void JobClient::read_events(const std::string& job_id, FollowState& following,
                            const EventSink& on_event) {
  const auto take = [&](const SseEvent& event) {
    following.last_id = event.id;
    following.losses = {};
    following.refused = 0;
    following.pause = patience_.first_pause;
    if (event.name != "queued") note_begun(following);
    if (is_final_event(event)) following.job = job_of(json_of(event.data));
    on_event(event);
  };
  SseParser parser;
  Headers headers = {{"Accept", "text/event-stream"}};
  if (!following.last_id.empty()) headers["Last-Event-ID"] = following.last_id;
  const Reply reply = ask_once([&](const Http& http) {
    return http.get(api::job_path(job_id) + "/events", headers,
                    [&](std::string_view bytes) { parser.feed(bytes, take); });
  });
  if (following.job) return;
  if (!reply.ok() && !is_busy(reply)) refuse(reply);
  read_state(job_id, following);  // no stream is available, or it ended early
}

void JobClient::read_state(const std::string& job_id, FollowState& following) {
  const Reply reply = ask_once([&](const Http& http) { return http.get(api::job_path(job_id)); });
  following.losses = {};
  if (is_busy(reply) && ++following.refused < patience_.refusals)
    return wait(title_of(json_of(reply.body)), retry_after(reply));
  if (!reply.ok()) refuse(reply);
  following.refused = 0;
  const api::Job now = job_of(json_of(reply.body));
  if (now.state != api::JobState::queued) note_begun(following);
  if (api::is_final(now.state)) following.job = now;
}

std::string JobClient::fetch(const std::string& job_id, const std::string& what) {
  std::string body;
  const Reply reply = ask([&](const Http& http) {
    body.clear();
    return http.get(api::job_path(job_id) + what, {},
                    [&](std::string_view bytes) { body += bytes; });
  });
  if (!reply.ok()) refuse(reply);
  return body;
}

void JobClient::fetch(const std::string& job_id, const std::string& what, const BytesSink& sink) {
  std::size_t passed_on = 0, known = 0;
  const Reply reply = ask([&](const Http& http) {
    known = passed_on;  // of this answer, which has the bytes of the one before
    return http.get(api::job_path(job_id) + what, {}, [&](std::string_view bytes) {
      const std::size_t old = std::min(known, bytes.size());
      known -= old;
      passed_on += bytes.size() - old;
      if (bytes.size() > old) sink(bytes.substr(old));
    });
  });
  if (!reply.ok()) refuse(reply);
  if (known > 0)
    throw Failure(ExitCode::unreachable,
                  "The server sent a shorter file the second time; try again.");
}

void JobClient::cancel(const std::string& job_id) {
  bool is_again = false;
  const Reply reply = ask([&](const Http& http) {
    // The answer to the first call may be lost, and the same call would remove a job that has
    // ended.
    if (std::exchange(is_again, true)) {
      Reply now = http.get(api::job_path(job_id));
      if (!now.ok() || api::is_final(job_of(json_of(now.body)).state)) return now;
    }
    return http.remove(api::job_path(job_id));
  });
  if (!reply.ok()) refuse(reply);
}

void JobClient::wait(const std::string& why, milliseconds duration) {
  if (!why.empty() && listener_.on_wait) listener_.on_wait(why);
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
