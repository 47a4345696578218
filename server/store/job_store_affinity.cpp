// The part of job_store.hpp about who has worked on what, for nodes that keep their work. It is a
// hint: it may be wrong, and it is lost with a crash of the database.
#include <string>
#include <utility>

#include "server/base/clock.hpp"
#include "server/store/job_rows.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server::store {

std::vector<WaitingJob> JobStore::first_waiting(std::string_view owner, int most) {
  const std::lock_guard lock(mutex_);
  database::Statement rows(
      *database_,
      "SELECT seq,"
      " (SELECT COUNT(*) FROM worked_on WHERE document = sha256 AND node = ?2),"
      " (SELECT COUNT(*) FROM worked_on JOIN nodes ON nodes.id = node"
      " WHERE document = sha256 AND node <> ?2 AND seen_ms > ?3)"
      " FROM jobs WHERE state = 'queued' AND owner = ?1 ORDER BY urgency, seq LIMIT ?4");
  rows.with(owner, node_.id, now_ms() - kNodeSeenMs, std::int64_t{most});
  std::vector<WaitingJob> jobs;
  while (rows.step())
    jobs.push_back({.seq = rows.number(0),
                    .is_known_here = rows.number(1) > 0,
                    .is_known_elsewhere = rows.number(2) > 0});
  return jobs;
}

std::optional<JobRecord> JobStore::take_one(std::int64_t seq, std::int64_t now_ms) {
  return transact([&]() -> std::optional<JobRecord> {
    database::Statement statement(
        *database_,
        "UPDATE jobs SET state = 'running', attempt = attempt + 1, node = ?2,"
        " beat = 0, started_ms = ?3 WHERE seq = ?1 AND state = 'queued'" +
            returning_jobs());
    std::vector<JobRecord> taken = job_rows(statement.with(seq, node_.id, now_ms));
    if (taken.empty()) return std::nullopt;
    database::Statement(*database_,
                        "INSERT INTO worked_on (document, node) VALUES (?1, ?2)"
                        " ON CONFLICT (document, node) DO UPDATE SET noted = excluded.noted")
        .with(taken.front().input.sha256, node_.id)
        .run();
    if (on_found_) on_found_(taken.front());
    return std::move(taken.front());
  });
}

void JobStore::forget_own_work() {
  change([&] {
    database::Statement(*database_, "DELETE FROM worked_on WHERE node = ?1").with(node_.id).run();
  });
}

void JobStore::forget_old_work() {
  change([&] {
    database::Statement(*database_,
                        "DELETE FROM worked_on WHERE noted < clock_timestamp() - INTERVAL '1 hour'")
        .run();
  });
}

}  // namespace unwrapd::server::store
