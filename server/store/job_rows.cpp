#include "server/store/job_rows.hpp"

#include <optional>
#include <stdexcept>
#include <utility>

#include "api/error_table.hpp"
#include "server/base/errors.hpp"
#include "server/base/files.hpp"

namespace unwrapd::server::store {
namespace {

using api::JobState;

constexpr std::string_view kColumns =
    " seq, id, state, created_ms, finished_ms, attempt, crashes, process_ends, cancel_requested, "
    "synchronous,"
    " expired, sha256, bytes, result_format, last_event, owner, urgency, request_key, content_key,"
    " stored_bytes, webhook, trace, asked, name, node, beat, started_ms, ran_ms, options, notes, "
    "buffers, problem ";

[[noreturn]] void unreadable(const std::string& column) {
  throw std::runtime_error("the column " + column + " cannot be read");
}

std::vector<StoredBuffer> buffers_of(const api::Json& json) {
  std::vector<StoredBuffer> buffers;
  for (const api::Json& entry : json)
    buffers.push_back({.uri = entry.at(0), .file = entry.at(1), .sha256 = {}});
  return buffers;
}

/// Reads the columns of a row in order.
class Columns {
 public:
  explicit Columns(const database::Statement& row) : row_(row) {}
  std::int64_t number() { return row_.number(column_++); }
  /// Call is_whole() afterwards: it is false if a number did not fit.
  int integer() {
    const std::int64_t value = number();
    is_whole_ = is_whole_ && std::in_range<int>(value);
    return static_cast<int>(value);
  }
  bool flag() { return number() != 0; }
  std::string text() { return row_.text(column_++); }
  [[nodiscard]] bool is_whole() const { return is_whole_; }

 private:
  const database::Statement& row_;
  int column_ = 0;
  bool is_whole_ = true;
};

/// Reads the first columns, none of which is JSON. Returns the state as it is written.
std::string read_plain(Columns& next, JobRecord& job) {
  job.seq = next.number();
  job.id = next.text();
  std::string state = next.text();
  job.created_ms = next.number();
  job.finished_ms = next.number();
  job.attempt = next.integer();
  job.crashes = next.integer();
  job.process_ends = next.integer();
  job.cancel_requested = next.flag();
  job.synchronous = next.flag();
  job.expired = next.flag();
  job.input.sha256 = next.text();
  job.input.bytes = next.number();
  job.result_format = next.text();
  job.last_event = next.number();
  job.owner = next.text();
  job.urgency = next.integer();
  job.request_key = next.text();
  job.content_key = next.text();
  job.stored_bytes = next.number();
  job.webhook = next.text();
  job.trace = next.text();
  job.asked = next.text();
  job.name = next.text();
  job.node = next.text();
  job.beat = next.number();
  job.started_ms = next.number();
  job.ran_ms = next.number();
  return state;
}

template <class Read>
void read_json(Columns& next, const std::string& column, const Read& read) {
  try {
    read(api::Json::parse(next.text()));
  } catch (const api::Json::exception&) {
    unreadable(column);
  }
}

void read_whole(Columns& next, const std::string& state, JobRecord& job) {
  if (!is_file_name(job.id)) unreadable("id");
  const std::optional<JobState> known = api::state_named(state);
  if (!known) unreadable("state");
  job.state = *known;
  if (!next.is_whole()) unreadable("attempt, crashes, process_ends or urgency");
  read_json(next, "options", [&](api::Json json) { job.options = std::move(json); });
  read_json(next, "notes", [&](const api::Json& json) { json.get_to(job.notes); });
  read_json(next, "buffers", [&](const api::Json& json) { job.input.buffers = buffers_of(json); });
  read_json(next, "problem", [&](api::Json json) {
    if (!json.is_null()) static_cast<void>(json.at("code"));
    job.problem = std::move(json);
  });
}

/// Reads an unreadable row as that of a failed job, so that it does not stop the reading of others.
JobRecord record_of(const database::Statement& row) {
  Columns next(row);
  JobRecord job;
  const std::string state = read_plain(next, job);
  try {
    read_whole(next, state, job);
  } catch (const std::exception& error) {
    job.unreadable = error.what();
    job.state = JobState::failed;
    job.options = api::Json::object();
    job.notes.clear();
    job.input.buffers.clear();
    job.problem = api::problem(unreadable_job(), job.id);
  }
  return job;
}

}  // namespace

std::string select_jobs(std::string_view rest) {
  return "SELECT" + std::string(kColumns) + "FROM jobs " + std::string(rest);
}

std::string returning_jobs() { return " RETURNING" + std::string(kColumns); }

std::vector<JobRecord> job_rows(database::Statement& statement) {
  std::vector<JobRecord> found;
  while (statement.step()) found.push_back(record_of(statement));
  return found;
}

api::Json buffers_json(const std::vector<StoredBuffer>& buffers) {
  api::Json json = api::Json::array();
  for (const StoredBuffer& buffer : buffers) json.push_back({buffer.uri, buffer.file});
  return json;
}

}  // namespace unwrapd::server::store
