#include "server/job_store.hpp"

#include "core/error.hpp"

namespace unwrapd::server {
namespace {

using api::JobState;
using api::state_name;

constexpr std::int64_t kSchemaVersion = 1;

constexpr const char* kSchema = R"sql(
CREATE TABLE jobs (
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  state TEXT NOT NULL,
  created_ms INTEGER NOT NULL,
  finished_ms INTEGER NOT NULL DEFAULT 0,
  attempt INTEGER NOT NULL DEFAULT 0,
  crashes INTEGER NOT NULL DEFAULT 0,
  cancel_requested INTEGER NOT NULL DEFAULT 0,
  synchronous INTEGER NOT NULL,
  expired INTEGER NOT NULL DEFAULT 0,
  options TEXT NOT NULL,
  notes TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  bytes INTEGER NOT NULL,
  buffers TEXT NOT NULL,
  result_format TEXT NOT NULL DEFAULT '',
  problem TEXT NOT NULL DEFAULT 'null',
  last_event INTEGER NOT NULL DEFAULT 0
) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, seq);
PRAGMA user_version = 1;
)sql";

constexpr std::string_view kColumns =
    " seq, id, state, created_ms, finished_ms, attempt, crashes, cancel_requested, synchronous,"
    " expired, options, notes, sha256, bytes, buffers, result_format, problem, last_event ";

std::string select(std::string_view rest) {
  return "SELECT" + std::string(kColumns) + "FROM jobs " + std::string(rest);
}

std::string text_of(const api::Json& json) {
  return json.dump(-1, ' ', false, api::Json::error_handler_t::replace);
}

api::Json buffers_json(const std::vector<StoredBuffer>& buffers) {
  api::Json json = api::Json::array();
  for (const StoredBuffer& buffer : buffers) json.push_back({buffer.uri, buffer.file});
  return json;
}

std::vector<StoredBuffer> buffers_of(const api::Json& json) {
  std::vector<StoredBuffer> buffers;
  for (const api::Json& entry : json)
    buffers.push_back({entry.at(0).get<std::string>(), entry.at(1).get<std::string>()});
  return buffers;
}

/// The row that a statement with kColumns stands on.
JobRecord record_of(const Statement& row) {
  JobRecord job;
  int column = 0;
  job.seq = row.number(column++);
  job.id = row.text(column++);
  job.state = api::state_named(row.text(column++)).value_or(JobState::failed);
  job.created_ms = row.number(column++);
  job.finished_ms = row.number(column++);
  job.attempt = static_cast<int>(row.number(column++));
  job.crashes = static_cast<int>(row.number(column++));
  job.cancel_requested = row.number(column++) != 0;
  job.synchronous = row.number(column++) != 0;
  job.expired = row.number(column++) != 0;
  job.options = api::Json::parse(row.text(column++));
  job.notes = api::Json::parse(row.text(column++)).get<std::vector<std::string>>();
  job.input.sha256 = row.text(column++);
  job.input.bytes = row.number(column++);
  job.input.buffers = buffers_of(api::Json::parse(row.text(column++)));
  job.result_format = row.text(column++);
  job.problem = api::Json::parse(row.text(column++));
  job.last_event = row.number(column++);
  return job;
}

}  // namespace

JobStore::JobStore(const std::filesystem::path& path) : database_(path) { migrate(); }

void JobStore::migrate() {
  Statement version(database_, "PRAGMA user_version");
  version.step();
  const std::int64_t found = version.number(0);
  if (found == kSchemaVersion) return;
  if (found != 0) {
    throw Error(ErrorCode::storage_failed,
                "The job store is of another version (schema " + std::to_string(found) +
                    "): start the version that wrote it, or choose another --data directory.");
  }
  database_.run("BEGIN IMMEDIATE");
  database_.run(kSchema);
  database_.run("COMMIT");
}

std::vector<JobRecord> JobStore::rows(Statement& statement) {
  std::vector<JobRecord> found;
  while (statement.step()) found.push_back(record_of(statement));
  return found;
}

std::int64_t JobStore::insert(const JobRecord& job) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_,
                      "INSERT INTO jobs (id, state, created_ms, synchronous, options, notes,"
                      " sha256, bytes, buffers) VALUES (?, 'queued', ?, ?, ?, ?, ?, ?, ?)"
                      " RETURNING seq");
  statement.with(job.id, job.created_ms, std::int64_t{job.synchronous}, text_of(job.options),
                 text_of(job.notes), job.input.sha256, job.input.bytes,
                 text_of(buffers_json(job.input.buffers)));
  statement.step();
  const std::int64_t seq = statement.number(0);
  statement.run();
  return seq;
}

std::optional<JobRecord> JobStore::find(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_, select("WHERE id = ?"));
  statement.with(id);
  if (!statement.step()) return std::nullopt;
  return record_of(statement);
}

std::vector<JobRecord> JobStore::all(JobState state) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_, select("WHERE state = ? ORDER BY seq"));
  statement.with(state_name(state));
  return rows(statement);
}

std::optional<JobRecord> JobStore::take_oldest() {
  const std::lock_guard lock(mutex_);
  Statement statement(
      database_,
      "UPDATE jobs SET state = 'running', attempt = attempt + 1 WHERE seq ="
      " (SELECT seq FROM jobs WHERE state = 'queued' ORDER BY seq LIMIT 1) RETURNING" +
          std::string(kColumns));
  std::vector<JobRecord> taken = rows(statement);
  if (taken.empty()) return std::nullopt;
  return std::move(taken.front());
}

bool JobStore::finish(const JobRecord& known, const JobOutcome& outcome) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_,
                      "UPDATE jobs SET state = ?4, result_format = ?5, problem = ?6,"
                      " last_event = ?7, finished_ms = ?8"
                      " WHERE id = ?1 AND attempt = ?2 AND state = ?3");
  statement
      .with(known.id, std::int64_t{known.attempt}, state_name(known.state),
            state_name(outcome.state), outcome.result_format, text_of(outcome.problem),
            outcome.last_event, outcome.finished_ms)
      .run();
  return database_.changes() == 1;
}

void JobStore::request_cancel(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Statement(database_, "UPDATE jobs SET cancel_requested = 1 WHERE id = ?").with(id).run();
}

void JobStore::requeue(std::string_view id, bool crashed) {
  const std::lock_guard lock(mutex_);
  Statement(database_,
            "UPDATE jobs SET state = 'queued', crashes = crashes + ?2"
            " WHERE id = ?1 AND state = 'running'")
      .with(id, std::int64_t{crashed})
      .run();
}

std::vector<std::string> JobStore::finished_before(std::int64_t epoch_ms) {
  const std::lock_guard lock(mutex_);
  Statement statement(database_,
                      "SELECT id FROM jobs WHERE state IN ('succeeded', 'failed', 'cancelled')"
                      " AND expired = 0 AND finished_ms < ? ORDER BY seq");
  statement.with(epoch_ms);
  std::vector<std::string> ids;
  while (statement.step()) ids.push_back(statement.text(0));
  return ids;
}

void JobStore::set_expired(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Statement(database_, "UPDATE jobs SET expired = 1 WHERE id = ?").with(id).run();
}

void JobStore::forget_before(std::int64_t epoch_ms) {
  const std::lock_guard lock(mutex_);
  Statement(database_, "DELETE FROM jobs WHERE expired = 1 AND finished_ms < ?")
      .with(epoch_ms)
      .run();
}

void JobStore::remove(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Statement(database_, "DELETE FROM jobs WHERE id = ?").with(id).run();
}

}  // namespace unwrapd::server
