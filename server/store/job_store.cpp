#include "server/store/job_store.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "api/error_table.hpp"
#include "server/database/schema.hpp"
#include "server/store/job_rows.hpp"

namespace unwrapd::server::store {
namespace {

using api::JobState;
using api::state_name;

constexpr std::int64_t kNotePauseMs = 60'000;          // an idle server writes no more often
constexpr std::int64_t kSpentKeptMs = 24 * 3'600'000;  // longer, as clocks are set back
constexpr auto kAnySeq = std::numeric_limits<std::int64_t>::max();

/// What a reader of a job's row finds there of its input.
std::string insert_statement() {
  return "INSERT INTO jobs (id, state, created_ms, synchronous, options, notes, sha256, bytes,"
         " buffers, owner, urgency, request_key, content_key, stored_bytes, webhook,"
         " trace, asked, name)"
         " VALUES (?, 'queued', ?, ?, ?, ?, ?, ?, ?, ?, ?, NULLIF(?, ''), ?, ?, ?, ?, ?, ?)"
         " ON CONFLICT DO NOTHING RETURNING seq";
}

/// Undoes an insertion. No std::exception, so that nobody takes it for an error of the store.
struct Refused {
  Insertion::Outcome why;
};

/// One statement for each filter, so that an index serves it in its order without looking at rows
/// of other owners or states.
std::string list_statement(const JobFilter& filter) {
  std::string where = "WHERE ";
  if (filter.owner) where += "owner = ?1 AND ";
  if (filter.state) where += "state = ?2 AND ";
  if (filter.name) where += "name = ?3 AND name <> '' AND ";  // as the indices of names say
  return select_jobs(where + "seq < ?4 ORDER BY seq DESC LIMIT ?5");
}

}  // namespace

JobOutcome ended(JobState state, const Error& why, std::string_view job) {
  JobOutcome outcome;
  outcome.state = state;
  outcome.problem = api::problem(why, job);
  return outcome;
}

JobStore::JobStore(const database::DatabaseAddress& address, RetentionClock::Read read, Node node)
    : node_(std::move(node)), database_(address.open()) {
  database_->claim();
  database_->check(false);
  database::migrate(*database_);
  database::Statement noted(*database_,
                            "SELECT set_by_ms, noted_ms, noted_elapsed_ms, boot FROM written");
  if (noted.step() && !node_.is_shared)
    noted_ = {.times = {noted.number(1), noted.number(2), noted.text(3)},
              .set_by_ms = noted.number(0)};
  time_.emplace(read, noted_);
  check_writable();
  if (!write_failed_ && !node_.is_shared) mend_sums();
}

std::int64_t JobStore::note_time() {
  const Times clocks = time_->clocks();
  const std::int64_t set_by_ms = now().set_by_ms;
  const std::int64_t by_ms = set_by_ms - noted_.set_by_ms;
  const bool was_set = std::abs(by_ms) >= kSetByMs;
  if (node_.is_shared) {
    noted_ = {.times = clocks, .set_by_ms = set_by_ms};
    return was_set ? by_ms : 0;
  }
  const bool is_noted = noted_.times.of_day_ms != 0 && noted_.times.boot == clocks.boot &&
                        clocks.elapsed_ms - noted_.times.elapsed_ms < kNotePauseMs;
  if (is_noted && !was_set) return 0;
  update("UPDATE written SET set_by_ms = ?, noted_ms = ?, noted_elapsed_ms = ?, boot = ?",
         set_by_ms, clocks.of_day_ms, clocks.elapsed_ms, clocks.boot);
  noted_ = {.times = clocks, .set_by_ms = set_by_ms};
  return was_set ? by_ms : 0;
}

void JobStore::check_writable() {
  if (database_->is_damaged()) {
    throw Error(ErrorCode::storage_failed,
                "The server's store is damaged; the operator must repair it.");
  }
  if (!write_failed_) {
    const std::lock_guard lock(mutex_);
    return database_->check_reachable();
  }
  try {
    transact([&] {
      database_->run("UPDATE jobs SET lease_ms = 0 WHERE seq < 0");
      database_->run("UPDATE written SET times = times + 1");
    });
  } catch (const Error& error) {  // results are read from a full disk, too, and removed from it
    if (error.code() != ErrorCode::storage_full) throw;
  }
}

template <class... Values>
std::optional<JobRecord> JobStore::first(std::string_view rest, const Values&... values) {
  std::vector<JobRecord> found;
  {
    const std::lock_guard lock(mutex_);
    database::Statement statement(*database_, select_jobs(rest));
    found = job_rows(statement.with(values...));
  }
  if (found.empty()) return std::nullopt;
  const JobRecord& job = found.front();
  if (on_found_) on_found_(job);
  return std::move(found.front());
}

std::int64_t JobStore::insert_row(const JobRecord& job) {
  database::Statement statement(*database_, insert_statement());
  statement.with(job.id, job.created_ms, std::int64_t{job.synchronous}, api::to_text(job.options),
                 api::to_text(job.notes), job.input.sha256, job.input.bytes,
                 api::to_text(buffers_json(job.input.buffers)), job.owner,
                 std::int64_t{job.urgency}, job.request_key, job.content_key, job.stored_bytes,
                 job.webhook, job.trace, job.asked, job.name);
  if (!statement.step()) return 0;
  const std::int64_t seq = statement.number(0);
  statement.run();
  return seq;
}

/// False when it was spent before.
bool JobStore::spend(const SpentTicket& ticket, std::int64_t now_ms) {
  database::Statement(*database_, "DELETE FROM spent_tickets WHERE until_ms < ?")
      .with(now_ms - kSpentKeptMs)
      .run();
  database::Statement(
      *database_,
      "INSERT INTO spent_tickets (id, until_ms) VALUES (?, ?) ON CONFLICT (id) DO NOTHING")
      .with(ticket.id, ticket.until_ms)
      .run();
  return database_->changes() > 0;
}

/// Once the job is inserted: the rows of its owner are locked from then on.
void JobStore::check_limits(const JobRecord& job, const OwnerLimits& limits) {
  if (limits.live_jobs == 0 && limits.stored_bytes == 0) return;
  database::Statement now(*database_,
                          "SELECT (SELECT waiting + running FROM shares WHERE owner = ?1), bytes"
                          " + (SELECT COALESCE(SUM(stored_bytes), 0) FROM meshes WHERE owner = ?1)"
                          " FROM stored WHERE owner = ?1");
  if (!now.with(job.owner).step()) return;
  if (limits.live_jobs > 0 && now.number(0) > limits.live_jobs)
    throw Refused{Insertion::Outcome::too_many_jobs};
  if (limits.stored_bytes > 0 && now.number(1) > limits.stored_bytes)
    throw Refused{Insertion::Outcome::too_many_bytes};
}

Insertion JobStore::insert(const JobRecord& job, const OwnerLimits& limits,
                           const std::optional<SpentTicket>& ticket, std::int64_t now_ms) {
  try {
    return transact([&]() -> Insertion {
      const std::int64_t seq = insert_row(job);
      if (seq == 0) throw Refused{Insertion::Outcome::known};
      if (ticket && !spend(*ticket, now_ms)) throw Refused{Insertion::Outcome::ticket_spent};
      check_limits(job, limits);
      return {.seq = seq};
    });
  } catch (const Refused& refused) {
    return {.outcome = refused.why};
  }
}

bool JobStore::is_spent(std::string_view ticket) {
  const std::lock_guard lock(mutex_);
  return database::Statement(*database_, "SELECT id FROM spent_tickets WHERE id = ?")
      .with(ticket)
      .step();
}

std::optional<JobRecord> JobStore::find(std::string_view id) { return first("WHERE id = ?", id); }

std::optional<JobRecord> JobStore::find_request(std::string_view owner,
                                                std::string_view request_key) {
  return first("WHERE owner = ? AND request_key = ?", owner, request_key);
}

std::optional<JobRecord> JobStore::find_same(std::string_view owner, std::string_view content_key) {
  return first(database_->dialect().by_index("jobs_by_content") +
                   " WHERE owner = ? AND content_key = ? AND state = 'succeeded' AND expired = 0"
                   " ORDER BY seq DESC LIMIT 1",
               owner, content_key);
}

std::vector<JobRecord> JobStore::unfinished() {
  const std::lock_guard lock(mutex_);
  database::Statement statement(
      *database_,
      select_jobs("WHERE seq IN (SELECT seq FROM jobs" +
                  database_->dialect().by_index("jobs_in_state") +
                  " WHERE state NOT IN ('succeeded', 'failed', 'cancelled')) ORDER BY seq"));
  return job_rows(statement);
}

std::vector<JobRecord> JobStore::list(const JobFilter& filter) {
  const std::lock_guard lock(mutex_);
  database::Statement statement(*database_, list_statement(filter));
  const std::string state(filter.state ? state_name(*filter.state) : "");
  const std::int64_t before = filter.before_seq > 0 ? filter.before_seq : kAnySeq;
  return job_rows(statement.with(filter.owner.value_or(""), state, filter.name.value_or(""), before,
                                 std::int64_t{filter.limit}));
}

bool JobStore::finish(const JobRecord& known, const JobOutcome& outcome) {
  const std::int64_t kept_since_ms = outcome.finished_ms - outcome.set_by_ms;
  return transact([&] {
    database::Statement statement(
        *database_,
        "UPDATE jobs SET state = ?4, result_format = ?5, problem = ?6,"
        " last_event = ?7, finished_ms = ?8, kept_since_ms = ?10, stored_bytes = ?9,"
        " ran_ms = ran_ms + ?11 WHERE seq = ?1 AND attempt = ?2 AND state = ?3");
    statement
        .with(known.seq, std::int64_t{known.attempt}, state_name(known.state),
              state_name(outcome.state), outcome.result_format, api::to_text(outcome.problem),
              outcome.last_event, outcome.finished_ms, outcome.stored_bytes, kept_since_ms,
              outcome.ran_ms)
        .run();
    if (database_->changes() != 1) return false;
    queue_delivery(known, outcome);
    return true;
  });
}

void JobStore::queue_delivery(const JobRecord& job, const JobOutcome& outcome) {
  if (job.webhook.empty()) return;
  database::Statement(*database_,
                      "INSERT INTO deliveries (job, owner, trace, url, body, due_ms)"
                      " VALUES (?, ?, ?, ?, ?, ?)")
      .with(job.id, job.owner, job.trace, job.webhook, outcome.delivery,
            outcome.finished_ms - outcome.set_by_ms)
      .run();
}

void JobStore::set_aside(const JobRecord& unreadable, const JobOutcome& outcome) {
  transact([&] {
    database::Statement(
        *database_,
        "UPDATE jobs SET state = ?2, problem = ?3, finished_ms = ?4, kept_since_ms = ?5,"
        " options = '{}', notes = '[]', buffers = '[]', attempt = ?6, crashes = 0, "
        "process_ends = 0, urgency = ?7,"
        " stored_bytes = 0 WHERE seq = ?1")
        .with(unreadable.seq, state_name(outcome.state), api::to_text(outcome.problem),
              outcome.finished_ms, outcome.finished_ms - outcome.set_by_ms,
              std::int64_t{std::max(0, unreadable.attempt)}, std::int64_t{kUsualUrgency})
        .run();
    queue_delivery(unreadable, outcome);
  });
}

void JobStore::request_cancel(std::string_view id) {
  update("UPDATE jobs SET cancel_requested = 1 WHERE id = ?", id);
}

void JobStore::note_process_end(std::string_view id) {
  update("UPDATE jobs SET process_ends = process_ends + 1 WHERE id = ? AND state = 'running'", id);
}

}  // namespace unwrapd::server::store
