#include "server/job_store.hpp"

#include <cstdlib>
#include <exception>
#include <limits>

#include "api/error_table.hpp"
#include "server/job_rows.hpp"
#include "server/schema.hpp"

namespace unwrapd::server {
namespace {

using api::JobState;
using api::state_name;

constexpr auto kAnySeq = std::numeric_limits<std::int64_t>::max();

/// What a reader of a job's row finds there of its input.
std::string insert_statement() {
  return "INSERT INTO jobs (id, state, created_ms, synchronous, options, notes, sha256, bytes,"
         " buffers, owner, urgency, request_key, content_key, stored_bytes, webhook,"
         " trace, asked)"
         " VALUES (?, 'queued', ?, ?, ?, ?, ?, ?, ?, ?, ?, NULLIF(?, ''), ?, ?, ?, ?, ?) RETURNING "
         "seq";
}

/// One for each case, so that an index serves it in its order: what is kept of others, or in other
/// states, is not looked at.
std::string list_statement(const JobFilter& filter) {
  std::string where = "WHERE ";
  if (filter.owner) where += "owner = ?1 AND ";
  if (filter.state) where += "state = ?2 AND ";
  return select_jobs(where + "seq < ?3 ORDER BY seq DESC LIMIT ?4");
}

}  // namespace

JobOutcome ended(JobState state, const Error& why, std::string_view job) {
  JobOutcome outcome;
  outcome.state = state;
  outcome.problem = api::problem(why, job);
  return outcome;
}

/// The store while it is written: it remembers whether that came about.
class JobStore::Writing {
 public:
  explicit Writing(JobStore& store)
      : store_(store), lock_(store.mutex_), errors_(std::uncaught_exceptions()) {}
  Writing(const Writing&) = delete;
  Writing& operator=(const Writing&) = delete;
  ~Writing() { store_.write_failed_ = std::uncaught_exceptions() > errors_; }

 private:
  JobStore& store_;
  const std::lock_guard<std::mutex> lock_;
  const int errors_;
};

JobStore::JobStore(const std::filesystem::path& path, KeptTime::Read read) : database_(path) {
  migrate(database_);
  Statement noted(database_, "SELECT set_by_ms FROM written");
  if (noted.step()) noted_set_by_ms_ = noted.number(0);
  time_.emplace(std::move(read), noted_set_by_ms_);
  check_writable();
}

std::int64_t JobStore::note_time() {
  const Writing writing(*this);
  const std::int64_t set_by_ms = now().set_by_ms;
  const std::int64_t by_ms = set_by_ms - noted_set_by_ms_;
  if (std::abs(by_ms) < kSetByMs) return 0;
  Statement(database_, "UPDATE written SET set_by_ms = ?").with(set_by_ms).run();
  noted_set_by_ms_ = set_by_ms;
  return by_ms;
}

void JobStore::check_writable() {
  if (!write_failed_) return;
  try {
    const Writing writing(*this);
    Transaction both(database_);
    database_.run("UPDATE jobs SET lease_ms = 0 WHERE seq < 0");
    database_.run("UPDATE written SET times = times + 1");
    both.commit();
  } catch (const Error& error) {  // results are read from a full disk, too, and removed from it
    if (error.code() != ErrorCode::storage_full) throw;
  }
}

template <class... Values>
std::optional<JobRecord> JobStore::first(std::string_view rest, const Values&... values) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_, select_jobs(rest));
  std::vector<JobRecord> found = job_rows(statement.with(values...));
  if (found.empty()) return std::nullopt;
  return std::move(found.front());
}

std::int64_t JobStore::insert(const JobRecord& job) {
  const Writing writing(*this);
  Statement statement(database_, insert_statement());
  statement.with(job.id, job.created_ms, std::int64_t{job.synchronous}, text_of(job.options),
                 text_of(job.notes), job.input.sha256, job.input.bytes,
                 text_of(buffers_json(job.input.buffers)), job.owner, std::int64_t{job.urgency},
                 job.request_key, job.content_key, job.stored_bytes, job.webhook, job.trace,
                 job.asked);
  statement.step();
  const std::int64_t seq = statement.number(0);
  statement.run();
  return seq;
}

std::optional<JobRecord> JobStore::find(std::string_view id) { return first("WHERE id = ?", id); }

std::optional<JobRecord> JobStore::find_request(std::string_view owner,
                                                std::string_view request_key) {
  return first("WHERE owner = ? AND request_key = ?", owner, request_key);
}

std::optional<JobRecord> JobStore::find_same(std::string_view owner, std::string_view content_key) {
  return first(
      "INDEXED BY jobs_by_content"
      " WHERE owner = ? AND content_key = ? AND state = 'succeeded' AND expired = 0"
      " ORDER BY seq DESC LIMIT 1",
      owner, content_key);
}

std::vector<JobRecord> JobStore::all(JobState state) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_, select_jobs("WHERE state = ? ORDER BY seq"));
  return job_rows(statement.with(state_name(state)));
}

std::vector<JobRecord> JobStore::list(const JobFilter& filter) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_, list_statement(filter));
  const std::string state(filter.state ? state_name(*filter.state) : "");
  const std::int64_t before = filter.before_seq > 0 ? filter.before_seq : kAnySeq;
  return job_rows(
      statement.with(filter.owner.value_or(""), state, before, std::int64_t{filter.limit}));
}

OwnerUsage JobStore::usage(std::string_view owner) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_,
                      "SELECT (SELECT COUNT(*) FROM jobs"
                      " WHERE owner = ?1 AND state IN ('queued', 'running')),"
                      " COALESCE((SELECT bytes FROM stored WHERE owner = ?1), 0)"
                      " + (SELECT COALESCE(SUM(stored_bytes), 0) FROM meshes WHERE owner = ?1)");
  statement.with(owner).step();
  return {.live_jobs = statement.number(0), .stored_bytes = statement.number(1)};
}

std::int64_t JobStore::evictable_bytes() {
  const std::lock_guard lock(mutex_);
  Statement statement(database_,
                      "SELECT (SELECT COALESCE(SUM(bytes), 0) FROM stored)"
                      " - (SELECT COALESCE(SUM(stored_bytes), 0) FROM jobs"
                      " WHERE state IN ('queued', 'running'))"
                      " + (SELECT COALESCE(SUM(stored_bytes), 0) FROM meshes"
                      " WHERE (owner, sha256) NOT IN (SELECT owner, sha256 FROM jobs"
                      " WHERE state IN ('queued', 'running')))");
  statement.step();
  return statement.number(0);
}

std::optional<JobRecord> JobStore::take(std::string_view owner, std::int64_t lease_ms) {
  const Writing writing(*this);
  Statement statement(database_,
                      "UPDATE jobs SET state = 'running', attempt = attempt + 1, lease_ms = ?2"
                      " WHERE seq = (SELECT seq FROM jobs WHERE state = 'queued' AND owner = ?1"
                      " ORDER BY urgency, seq LIMIT 1)" +
                          returning_jobs());
  std::vector<JobRecord> taken = job_rows(statement.with(owner, lease_ms));
  if (taken.empty()) return std::nullopt;
  return std::move(taken.front());
}

void JobStore::renew(std::string_view id, std::int64_t lease_ms) {
  const Writing writing(*this);
  Statement(database_, "UPDATE jobs SET lease_ms = ?2 WHERE id = ?1 AND state = 'running'")
      .with(id, lease_ms)
      .run();
}

std::vector<JobRecord> JobStore::lapsed(std::int64_t now_ms) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_,
                      select_jobs("WHERE state = 'running' AND lease_ms < ? ORDER BY seq"));
  return job_rows(statement.with(now_ms));
}

bool JobStore::finish(const JobRecord& known, const JobOutcome& outcome) {
  const Writing writing(*this);
  const std::int64_t kept_since_ms = outcome.finished_ms - outcome.set_by_ms;
  Transaction both(database_);
  Statement statement(database_,
                      "UPDATE jobs SET state = ?4, result_format = ?5, problem = ?6,"
                      " last_event = ?7, finished_ms = ?8, kept_since_ms = ?10, stored_bytes = ?9"
                      " WHERE id = ?1 AND attempt = ?2 AND state = ?3");
  statement
      .with(known.id, std::int64_t{known.attempt}, state_name(known.state),
            state_name(outcome.state), outcome.result_format, text_of(outcome.problem),
            outcome.last_event, outcome.finished_ms, outcome.stored_bytes, kept_since_ms)
      .run();
  if (database_.changes() != 1) return false;
  if (!known.webhook.empty()) {
    Statement(database_,
              "INSERT INTO deliveries (job, owner, trace, url, body, due_ms)"
              " VALUES (?, ?, ?, ?, ?, ?)")
        .with(known.id, known.owner, known.trace, known.webhook, outcome.delivery, kept_since_ms)
        .run();
  }
  both.commit();
  return true;
}

void JobStore::request_cancel(std::string_view id) {
  const Writing writing(*this);
  Statement(database_, "UPDATE jobs SET cancel_requested = 1 WHERE id = ?").with(id).run();
}

void JobStore::requeue(std::string_view id, bool crashed) {
  const Writing writing(*this);
  Statement(database_,
            "UPDATE jobs SET state = 'queued', crashes = crashes + ?2"
            " WHERE id = ?1 AND state = 'running'")
      .with(id, std::int64_t{crashed})
      .run();
}

bool JobStore::keeps_files(std::string_view id) {
  const std::optional<JobRecord> job = find(id);
  if (!job || job->expired) return false;
  return !api::is_final(job->state) || job->state == JobState::succeeded;
}

std::vector<std::string> JobStore::finished_before(std::int64_t epoch_ms, int limit) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_,
                      "SELECT id FROM jobs WHERE state IN ('succeeded', 'failed', 'cancelled')"
                      " AND expired = 0 AND kept_since_ms < ? ORDER BY kept_since_ms, seq LIMIT ?");
  statement.with(epoch_ms, std::int64_t{limit});
  std::vector<std::string> ids;
  while (statement.step()) ids.push_back(statement.text(0));
  return ids;
}

void JobStore::set_stored_bytes(std::string_view id, std::int64_t bytes) {
  const Writing writing(*this);
  Statement(database_, "UPDATE jobs SET stored_bytes = ?2 WHERE id = ?1 AND expired = 0")
      .with(id, bytes)
      .run();
}

void JobStore::set_expired(std::string_view id) {
  const Writing writing(*this);
  Statement(database_, "UPDATE jobs SET expired = 1, stored_bytes = 0 WHERE id = ?").with(id).run();
}

void JobStore::forget_before(std::int64_t epoch_ms) {
  const Writing writing(*this);
  Statement(database_, "DELETE FROM jobs WHERE expired = 1 AND kept_since_ms < ?")
      .with(epoch_ms)
      .run();
}

void JobStore::remove(std::string_view id) {
  const Writing writing(*this);
  Statement(database_, "DELETE FROM jobs WHERE id = ?").with(id).run();
}

}  // namespace unwrapd::server
