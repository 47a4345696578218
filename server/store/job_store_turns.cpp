// The part of job_store.hpp about turns: which job is next, who runs it, and whether that node
// lives.
#include <string>
#include <utility>

#include "server/base/clock.hpp"
#include "server/store/job_rows.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server::store {
namespace {

constexpr std::int64_t kForgottenMs = 86'400'000;  // and as never been
constexpr double kSecondsPerMs = 1e-3;

}  // namespace

QueueCounts JobStore::counts() {
  const std::lock_guard lock(mutex_);
  database::Statement sums(*database_,
                           "SELECT COALESCE(SUM(waiting), 0), COALESCE(SUM(running), 0), COUNT(*)"
                           " FROM shares WHERE waiting + running > 0");
  sums.step();
  return {.waiting = sums.number(0), .running = sums.number(1), .owners = sums.number(2)};
}

std::optional<std::int64_t> JobStore::first_waiting_ms() {
  const std::lock_guard lock(mutex_);
  database::Statement first(
      *database_, "SELECT created_ms FROM jobs WHERE state = 'queued' ORDER BY seq LIMIT 1");
  if (!first.step()) return std::nullopt;
  return first.number(0);
}

std::optional<std::string> JobStore::next_owner(std::int64_t mean_ms) {
  const std::lock_guard lock(mutex_);
  database::Statement least(*database_,
                            "SELECT owner FROM shares WHERE waiting > 0"
                            " ORDER BY served_ms + running * ?, owner LIMIT 1");
  if (!least.with(mean_ms).step()) return std::nullopt;
  return least.text(0);
}

/// Where nobody has jobs, all start level again.
void JobStore::level_shares() {
  constexpr const char* kRest =
      " FROM shares WHERE waiting + running = 0 AND served_ms <= COALESCE("
      "(SELECT MIN(served_ms) FROM shares WHERE waiting + running > 0), served_ms)";
  {
    const std::lock_guard lock(mutex_);
    if (database::number_of(*database_, "SELECT COUNT(*)" + std::string(kRest)) == 0) return;
  }
  update("DELETE" + std::string(kRest));
}

std::vector<double> JobStore::last_lengths(int count) {
  const std::lock_guard lock(mutex_);
  database::Statement rows(
      *database_,
      "SELECT ran_ms FROM (SELECT ran_ms, kept_since_ms FROM jobs WHERE expired = 0"
      " AND kept_since_ms > 0 ORDER BY kept_since_ms DESC LIMIT ?) AS newest"
      " WHERE ran_ms > 0 ORDER BY kept_since_ms DESC");
  rows.with(std::int64_t{count});
  std::vector<double> seconds;
  while (rows.step()) seconds.push_back(static_cast<double>(rows.number(0)) * kSecondsPerMs);
  return seconds;
}

std::optional<JobRecord> JobStore::take(std::string_view owner, std::int64_t now_ms) {
  return change([&]() -> std::optional<JobRecord> {
    database::Statement statement(
        *database_,
        "UPDATE jobs SET state = 'running', attempt = attempt + 1, node = ?2,"
        " beat = 0, started_ms = ?3 WHERE seq = (SELECT seq FROM jobs"
        " WHERE state = 'queued' AND owner = ?1 ORDER BY urgency, seq LIMIT 1" +
            std::string(database_->dialect().skip_locked) + ")" + returning_jobs());
    std::vector<JobRecord> taken = job_rows(statement.with(owner, node_.id, now_ms));
    if (taken.empty()) return std::nullopt;
    if (on_found_) on_found_(taken.front());
    return std::move(taken.front());
  });
}

bool JobStore::beat(const JobRecord& job) {
  return change([&] {
    database::Statement(
        *database_,
        "UPDATE jobs SET beat = beat + 1 WHERE seq = ?1 AND attempt = ?2 AND node = ?3"
        " AND state = 'running'")
        .with(job.seq, std::int64_t{job.attempt}, node_.id)
        .run();
    return database_->changes() == 1;
  });
}

std::vector<JobRecord> JobStore::running(bool on_others) {
  const std::lock_guard lock(mutex_);
  const std::string_view others = on_others ? " AND node <> ?" : "";
  database::Statement statement(
      *database_, select_jobs("WHERE state = 'running'" + std::string(others) + " ORDER BY seq"));
  if (on_others) statement.bind(1, node_.id);
  return job_rows(statement);
}

std::vector<std::string> JobStore::cancelled_here() {
  const std::lock_guard lock(mutex_);
  database::Statement rows(*database_,
                           "SELECT id FROM jobs WHERE state = 'running' AND node = ?"
                           " AND cancel_requested = 1");
  rows.with(node_.id);
  std::vector<std::string> ids;
  while (rows.step()) ids.push_back(rows.text(0));
  return ids;
}

std::int64_t JobStore::announce(std::int64_t workers) {
  const std::int64_t now = now_ms();
  return transact([&] {
    database::Statement(
        *database_,
        "INSERT INTO nodes (id, workers, seen_ms) VALUES (?, ?, ?) ON CONFLICT (id) DO UPDATE"
        " SET workers = excluded.workers, seen_ms = excluded.seen_ms")
        .with(node_.id, workers, now)
        .run();
    database::Statement(*database_, "DELETE FROM nodes WHERE seen_ms < ?")
        .with(now - kForgottenMs)
        .run();
    database::Statement seen(
        *database_,
        "SELECT CAST(COALESCE(SUM(workers), 0) AS BIGINT) FROM nodes WHERE seen_ms > ?");
    seen.with(now - kNodeSeenMs).step();
    return seen.number(0);
  });
}

bool JobStore::requeue(const JobRecord& known, bool crashed, std::int64_t ran_ms) {
  return change([&] {
    database::Statement(
        *database_,
        "UPDATE jobs SET state = 'queued', crashes = crashes + ?4, ran_ms = ran_ms + ?5"
        " WHERE seq = ?1 AND attempt = ?2 AND beat = ?3 AND state = 'running'")
        .with(known.seq, std::int64_t{known.attempt}, known.beat, std::int64_t{crashed}, ran_ms)
        .run();
    return database_->changes() == 1;
  });
}

}  // namespace unwrapd::server::store
