#include "server/job_rows.hpp"

namespace unwrapd::server {
namespace {

using api::JobState;

constexpr std::string_view kColumns =
    " seq, id, state, created_ms, finished_ms, attempt, crashes, cancel_requested, synchronous,"
    " expired, options, notes, sha256, bytes, buffers, result_format, problem, last_event, owner,"
    " urgency, request_key, content_key, stored_bytes, webhook, trace, asked ";

std::vector<StoredBuffer> buffers_of(const api::Json& json) {
  std::vector<StoredBuffer> buffers;
  for (const api::Json& entry : json)
    buffers.push_back({.uri = entry.at(0), .file = entry.at(1), .sha256 = {}});
  return buffers;
}

/// Columns of a row, from the first on.
class Columns {
 public:
  explicit Columns(const Statement& row) : row_(row) {}
  std::int64_t number() { return row_.number(column_++); }
  int integer() { return static_cast<int>(number()); }
  bool flag() { return number() != 0; }
  std::string text() { return row_.text(column_++); }
  api::Json json() { return api::Json::parse(text()); }

 private:
  const Statement& row_;
  int column_ = 0;
};

JobRecord record_of(const Statement& row) {
  Columns next(row);
  JobRecord job;
  job.seq = next.number();
  job.id = next.text();
  job.state = api::state_named(next.text()).value_or(JobState::failed);
  job.created_ms = next.number();
  job.finished_ms = next.number();
  job.attempt = next.integer();
  job.crashes = next.integer();
  job.cancel_requested = next.flag();
  job.synchronous = next.flag();
  job.expired = next.flag();
  job.options = next.json();
  job.notes = next.json().get<std::vector<std::string>>();
  job.input.sha256 = next.text();
  job.input.bytes = next.number();
  job.input.buffers = buffers_of(next.json());
  job.result_format = next.text();
  job.problem = next.json();
  job.last_event = next.number();
  job.owner = next.text();
  job.urgency = next.integer();
  job.request_key = next.text();
  job.content_key = next.text();
  job.stored_bytes = next.number();
  job.webhook = next.text();
  job.trace = next.text();
  job.asked = next.text();
  return job;
}

}  // namespace

std::string select_jobs(std::string_view rest) {
  return "SELECT" + std::string(kColumns) + "FROM jobs " + std::string(rest);
}

std::string returning_jobs() { return " RETURNING" + std::string(kColumns); }

std::vector<JobRecord> job_rows(Statement& statement) {
  std::vector<JobRecord> found;
  while (statement.step()) found.push_back(record_of(statement));
  return found;
}

std::string text_of(const api::Json& json) {
  return json.dump(-1, ' ', false, api::Json::error_handler_t::replace);
}

api::Json buffers_json(const std::vector<StoredBuffer>& buffers) {
  api::Json json = api::Json::array();
  for (const StoredBuffer& buffer : buffers) json.push_back({buffer.uri, buffer.file});
  return json;
}

}  // namespace unwrapd::server
