#include "server/store/event_channel.hpp"

#include <poll.h>

#include <array>

#include "api/json.hpp"
#include "server/store/job_rows.hpp"

namespace unwrapd::server::store {
namespace {

/// Plans are kept: one that is made while the tables are small must not read them whole ever after.
/// So each row is looked for by itself (kAfter, kEnded), and by an index.
constexpr const char* kEventSession =
    "SET default_transaction_read_only = off; SET synchronous_commit = off;"
    " SET enable_seqscan = off";
constexpr const char* kAppend =
    "INSERT INTO events (job, seq, last, frame, progress)"
    " SELECT job, seq, last, frame, progress FROM json_to_recordset(CAST(? AS json))"
    " AS new (job text, seq bigint, last bigint, frame text, progress text)"
    " ON CONFLICT (job, seq) DO NOTHING";
constexpr const char* kAfter =
    "SELECT job, new.seq, last, frame, progress"
    " FROM json_to_recordset(CAST(? AS json)) AS seen (job text, seq bigint)"
    " CROSS JOIN LATERAL (SELECT seq, last, frame, progress FROM events"
    " WHERE events.job = seen.job AND events.seq > seen.seq ORDER BY seq LIMIT 1000000) AS new"
    " ORDER BY 1, 2";
constexpr const char* kEnded =
    "SELECT job FROM json_to_recordset(CAST(? AS json)) AS seen (job text, seq bigint)"
    " WHERE COALESCE((SELECT state NOT IN ('queued', 'running') FROM jobs WHERE id = job), true)";
constexpr const char* kForget =
    "DELETE FROM events WHERE job NOT IN (SELECT id FROM jobs"
    " WHERE state IN ('queued', 'running') OR finished_ms >= ?)";

std::string positions(const std::vector<EventChannel::JobAndSeq>& jobs) {
  api::Json all = api::Json::array();
  for (const auto& [job, seq] : jobs) all.push_back({{"job", job}, {"seq", seq}});
  return api::to_text(all);
}

}  // namespace

EventChannel::EventChannel(const database::PostgresAddress& address) : link_(address.url) {
  link_.run(kEventSession);
  channel_ = link_.run("SELECT 'unwrapd_' || md5(current_schema())").text(0, 0);
}

void EventChannel::append(const std::vector<EventRow>& events) {
  api::Json all = api::Json::array();
  for (const EventRow& event : events)
    all.push_back({{"job", event.job},
                   {"seq", event.seq},
                   {"last", int{event.is_last}},
                   {"frame", event.frame},
                   {"progress", event.progress}});
  link_.run(kAppend, {{.text = api::to_text(all), .type = database::kTextType}});
}

std::vector<EventRow> EventChannel::after(const std::vector<JobAndSeq>& jobs) {
  const database::PostgresResult rows =
      link_.run(kAfter, {{.text = positions(jobs), .type = database::kTextType}});
  std::vector<EventRow> events;
  for (int row = 0; row < rows.rows(); ++row)
    events.push_back({.job = rows.text(row, 0),
                      .seq = database::number_in(rows.text(row, 1)),
                      .is_last = database::number_in(rows.text(row, 2)) != 0,
                      .frame = rows.text(row, 3),
                      .progress = rows.text(row, 4)});
  return events;
}

std::vector<std::string> EventChannel::ended(const std::vector<JobAndSeq>& jobs) {
  const database::PostgresResult rows =
      link_.run(kEnded, {{.text = positions(jobs), .type = database::kTextType}});
  std::vector<std::string> ids;
  for (int row = 0; row < rows.rows(); ++row) ids.push_back(rows.text(row, 0));
  return ids;
}

void EventChannel::forget_before(std::int64_t finished_ms) {
  link_.run(kForget, {{.text = std::to_string(finished_ms), .type = database::kNumberType}});
}

void EventChannel::hint(std::string_view text) {
  link_.run("SELECT pg_notify(?, ?)", {{.text = channel_, .type = database::kTextType},
                                       {.text = std::string(text), .type = database::kTextType}});
}

void EventChannel::listen() { link_.run("LISTEN " + channel_); }

std::vector<std::string> EventChannel::wait(std::chrono::milliseconds time, const Wakeup& bell) {
  std::vector<std::string> hints = link_.notifications();  // of those that came with answers
  if (!hints.empty()) return hints;
  std::array<pollfd, 2> waited = {{{.fd = link_.socket(), .events = POLLIN, .revents = 0},
                                   {.fd = bell.descriptor(), .events = POLLIN, .revents = 0}}};
  ::poll(waited.data(), waited.size(), static_cast<int>(time.count()));
  if (waited[1].revents != 0) bell.answer();
  return link_.notifications();
}

}  // namespace unwrapd::server::store
