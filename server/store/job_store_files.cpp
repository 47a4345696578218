// The part of job_store.hpp about the files of jobs and the bytes that they take.
#include <string>

#include "server/store/job_store.hpp"

namespace unwrapd::server::store {

OwnerUsage JobStore::usage(std::string_view owner) {
  const std::lock_guard lock(mutex_);
  database::Statement statement(
      *database_,
      "SELECT (SELECT COUNT(*) FROM jobs"
      " WHERE owner = ?1 AND state IN ('queued', 'running')),"
      " COALESCE((SELECT bytes FROM stored WHERE owner = ?1), 0)"
      " + (SELECT COALESCE(SUM(stored_bytes), 0) FROM meshes WHERE owner = ?1)");
  statement.with(owner).step();
  return {.live_jobs = statement.number(0), .stored_bytes = statement.number(1)};
}

std::int64_t JobStore::stored_bytes() {
  const std::lock_guard lock(mutex_);
  return database::number_of(*database_,
                             "SELECT (SELECT COALESCE(SUM(bytes), 0) FROM stored)"
                             " + (SELECT COALESCE(SUM(stored_bytes), 0) FROM meshes)");
}

std::int64_t JobStore::evictable_bytes() {
  const std::lock_guard lock(mutex_);
  return database::number_of(*database_,
                             "SELECT (SELECT COALESCE(SUM(bytes), 0) FROM stored)"
                             " - (SELECT COALESCE(SUM(stored_bytes), 0) FROM jobs"
                             " WHERE state IN ('queued', 'running'))"
                             " + (SELECT COALESCE(SUM(stored_bytes), 0) FROM meshes"
                             " WHERE (owner, sha256) NOT IN (SELECT owner, sha256 FROM jobs"
                             " WHERE state IN ('queued', 'running')))");
}

/// The triggers keep the sums; a damaged one would be kept, too.
void JobStore::mend_sums() {
  const std::string right = "SELECT owner, SUM(stored_bytes), COUNT(*) FROM jobs GROUP BY owner";
  const std::string noted = "SELECT owner, bytes, jobs FROM stored";
  database::Statement wrong(*database_, "SELECT * FROM (" + right + " EXCEPT " + noted +
                                            ") AS wrong UNION ALL SELECT * FROM (" + noted +
                                            " WHERE bytes <> 0 OR jobs <> 0 EXCEPT " + right +
                                            ") AS left_over LIMIT 1");
  if (wrong.step()) {
    transact([&] {
      database_->run("DELETE FROM stored");
      database_->run("INSERT INTO stored " + right);
    });
  }
  mend_shares();
}

void JobStore::mend_shares() {
  const std::string right =
      "SELECT owner, COUNT(*) FILTER (WHERE state = 'queued'),"
      " COUNT(*) FILTER (WHERE state = 'running') FROM jobs" +
      database_->dialect().by_index("jobs_by_state") +
      " WHERE state IN ('queued', 'running') GROUP BY owner";
  const std::string noted =
      "SELECT owner, waiting, running FROM shares WHERE waiting <> 0 OR running <> 0";
  database::Statement wrong(*database_, "SELECT * FROM (" + right + " EXCEPT " + noted +
                                            ") AS wrong UNION ALL SELECT * FROM (" + noted +
                                            " EXCEPT " + right + ") AS left_over LIMIT 1");
  if (!wrong.step()) return;
  transact([&] {
    database_->run("DELETE FROM shares");
    database_->run("INSERT INTO shares (owner, waiting, running) " + right);
  });
}

blobs::FolderFate JobStore::fate_of(std::string_view id) {
  const std::optional<JobRecord> job = find(id);
  if (!job || !job->unreadable.empty()) return blobs::FolderFate::unknown;
  if (job->expired) return blobs::FolderFate::gone;
  const bool keeps = !api::is_final(job->state) || job->state == api::JobState::succeeded;
  return keeps ? blobs::FolderFate::kept : blobs::FolderFate::gone;
}

std::vector<std::string> JobStore::finished_before(std::int64_t epoch_ms, int limit) {
  const std::lock_guard lock(mutex_);
  database::Statement statement(
      *database_,
      "SELECT id FROM jobs WHERE state IN ('succeeded', 'failed', 'cancelled')"
      " AND expired = 0 AND kept_since_ms < ? ORDER BY kept_since_ms, seq LIMIT ?");
  statement.with(epoch_ms, std::int64_t{limit});
  std::vector<std::string> ids;
  while (statement.step()) ids.push_back(statement.text(0));
  return ids;
}

std::int64_t JobStore::job_count() {
  const std::lock_guard lock(mutex_);
  return database::number_of(*database_, "SELECT COALESCE(SUM(jobs), 0) FROM stored");
}

/// Both are served by indices in their order, however many jobs there are.
std::optional<std::string> JobStore::first_to_go() {
  const std::lock_guard lock(mutex_);
  for (const char* sql :
       {"SELECT id FROM jobs WHERE expired = 1 ORDER BY kept_since_ms LIMIT 1",
        "WITH ended (state) AS (VALUES ('succeeded'), ('failed'), ('cancelled')),"
        " firsts AS (SELECT jobs, owner, (SELECT MIN(seq) FROM (SELECT (SELECT MIN(seq) FROM jobs"
        " WHERE jobs.owner = stored.owner AND jobs.state = ended.state) AS seq FROM ended) AS "
        "of_state) AS seq"
        " FROM stored)"
        " SELECT id FROM jobs WHERE seq = (SELECT seq FROM firsts WHERE seq IS NOT NULL"
        " ORDER BY jobs DESC, owner LIMIT 1)"}) {
    database::Statement statement(*database_, sql);
    if (statement.step()) return statement.text(0);
  }
  return std::nullopt;
}

void JobStore::set_stored_bytes(std::string_view id, std::int64_t bytes) {
  update("UPDATE jobs SET stored_bytes = ?2 WHERE id = ?1 AND expired = 0", id, bytes);
}

void JobStore::mend_stored_bytes(const std::vector<std::pair<std::string, std::int64_t>>& jobs) {
  try {
    transact([&] {
      for (const auto& [id, bytes] : jobs) {
        database::Statement(*database_,
                            "UPDATE jobs SET stored_bytes = ?2 WHERE id = ?1 AND stored_bytes <> ?2"
                            " AND state = 'succeeded' AND expired = 0")
            .with(id, bytes)
            .run();
      }
    });
  } catch (const Error& error) {  // a later start mends them
    if (error.code() != ErrorCode::storage_full) throw;
  }
}

void JobStore::set_expired(std::string_view id) {
  update("UPDATE jobs SET expired = 1, stored_bytes = 0 WHERE id = ?", id);
}

void JobStore::forget_before(std::int64_t epoch_ms) {
  update("DELETE FROM jobs WHERE expired = 1 AND kept_since_ms < ?", epoch_ms);
}

void JobStore::remove(std::string_view id) { update("DELETE FROM jobs WHERE id = ?", id); }

}  // namespace unwrapd::server::store
