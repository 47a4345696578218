// The part of job_store.hpp about work that several processes share. Rows last as long as their job
// runs; where they are lost, as with a crash of the database, their work is done again.
#include <algorithm>
#include <string>
#include <utility>

#include "core/asset/base/base64.hpp"
#include "server/store/job_rows.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server::store {

/// A later attempt of the job begins its stages anew, and finds the bundles of the one before.
bool JobStore::open_stage(const StageOfJob& of, int bundles) {
  return change([&] {
    database::Statement(*database_,
                        "INSERT INTO shared_stages (job, stage, program, attempt, bundles)"
                        " VALUES (?1, ?2, ?3, ?4, ?5) ON CONFLICT (job, stage) DO UPDATE"
                        " SET attempt = excluded.attempt, from_front = 0, from_back = 0"
                        " WHERE shared_stages.attempt < excluded.attempt")
        .with(of.job, of.stage, UNWRAPD_VERSION, std::int64_t{of.attempt}, std::int64_t{bundles})
        .run();
    return database_->changes() == 1;
  });
}

std::optional<int> JobStore::claim_bundle(const StageOfJob& of, bool is_helper) {
  const std::string end = is_helper ? "from_back" : "from_front";
  return change([&]() -> std::optional<int> {
    database::Statement claim(*database_,
                              "UPDATE shared_stages SET " + end + " = " + end +
                                  " + 1 WHERE job = ?1 AND stage = ?2 AND attempt = ?3"
                                  " AND from_front + from_back < bundles RETURNING " +
                                  (is_helper ? "bundles - from_back" : "from_front - 1"));
    claim.with(of.job, of.stage, std::int64_t{of.attempt});
    if (!claim.step()) return std::nullopt;
    return static_cast<int>(claim.number(0));
  });
}

/// Bytes that were kept before turned out to be unsound.
void JobStore::keep_bundle(const StageOfJob& of, int bundle, std::string_view bytes) {
  std::string text;
  asset::append_base64(text, bytes);
  update(
      "INSERT INTO shared_bundles (job, stage, bundle, bytes) SELECT job, stage, ?3, ?4"
      " FROM shared_stages WHERE job = ?1 AND stage = ?2 AND attempt = ?5"
      " ON CONFLICT (job, stage, bundle) DO UPDATE SET bytes = excluded.bytes",
      of.job, of.stage, std::int64_t{bundle}, text, std::int64_t{of.attempt});
}

std::optional<std::string> JobStore::bundle(const StageOfJob& of, int bundle) {
  const std::lock_guard lock(mutex_);
  database::Statement row(
      *database_, "SELECT bytes FROM shared_bundles WHERE job = ?1 AND stage = ?2 AND bundle = ?3");
  if (!row.with(of.job, of.stage, std::int64_t{bundle}).step()) return std::nullopt;
  return asset::base64_decoded(row.text(0));
}

bool JobStore::is_running(std::int64_t job, int attempt) {
  const std::lock_guard lock(mutex_);
  database::Statement row(*database_,
                          "SELECT 1 FROM jobs WHERE seq = ?1 AND attempt = ?2 AND state = 'running'"
                          " AND cancel_requested = 0");
  return row.with(job, std::int64_t{attempt}).step();
}

std::optional<JobRecord> JobStore::job_to_help(const std::vector<std::int64_t>& passed_over) {
  const std::lock_guard lock(mutex_);
  database::Statement rows(
      *database_,
      select_jobs("WHERE state = 'running' AND cancel_requested = 0 AND seq IN (SELECT job"
                  " FROM shared_stages WHERE from_front + from_back < bundles AND program = ?"
                  " AND shared_stages.attempt = jobs.attempt) ORDER BY"
                  " (SELECT served_ms FROM shares WHERE shares.owner = jobs.owner), seq"));
  for (JobRecord& job : job_rows(rows.with(UNWRAPD_VERSION)))
    if (std::ranges::find(passed_over, job.seq) == passed_over.end()) return std::move(job);
  return std::nullopt;
}

void JobStore::charge(std::string_view owner, std::int64_t ms) {
  update("UPDATE shares SET served_ms = served_ms + ?2 WHERE owner = ?1", owner, ms);
}

void JobStore::drop_shared_work(std::int64_t job) {
  transact([&] {
    database::Statement(*database_, "DELETE FROM shared_stages WHERE job = ?").with(job).run();
    database::Statement(*database_, "DELETE FROM shared_bundles WHERE job = ?").with(job).run();
  });
}

void JobStore::drop_ended_shared_work() {
  constexpr const char* kEnded =
      " WHERE job NOT IN (SELECT seq FROM jobs WHERE state IN ('queued', 'running'))";
  {
    const std::lock_guard lock(mutex_);
    database::Statement any(*database_,
                            "SELECT 1 FROM shared_stages UNION ALL SELECT 1 FROM shared_bundles");
    if (!any.step()) return;
  }
  transact([&] {
    database::Statement(*database_, std::string("DELETE FROM shared_stages") + kEnded).run();
    database::Statement(*database_, std::string("DELETE FROM shared_bundles") + kEnded).run();
  });
}

}  // namespace unwrapd::server::store
