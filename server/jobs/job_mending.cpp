// The part of job_queue.hpp for a store that could not be reached for a while: what this queue
// knows and what the rows say is made the same again.
#include <algorithm>

#include "server/base/trace.hpp"
#include "server/jobs/job_queue.hpp"

namespace unwrapd::server::jobs {

using api::JobState;

namespace {

bool waits(const store::JobRecord& job) {
  return job.unreadable.empty() && job.state == JobState::queued && !job.cancel_requested;
}

}  // namespace

void JobQueue::mend() {
  const std::lock_guard lock(mutex_);
  must_mend_ |= store_.was_away();
  if (!must_mend_) return;
  const std::vector<store::JobRecord> unfinished = store_.unfinished();
  leases_.forget();
  changed_.notify_all();
  for (const store::JobRecord& job : unfinished) mend_row(job);
  const std::set<std::string> doubted = doubted_;
  for (const std::string& id : doubted) settle_doubt(id);
  must_mend_ = false;
  log_.info("the store is reached again", {{"unfinished", unfinished.size()}});
}

/// By its worker, or for take_up_left().
bool JobQueue::is_known_elsewhere(const store::JobRecord& job) const {
  return running_.contains(job.id) || std::ranges::find(left_, job.id) != left_.end();
}

/// A job that runs in the store alone was taken by a call that never heard of it.
void JobQueue::mend_row(const store::JobRecord& job) {
  const store::Node& here = store_.node();
  const bool is_of_others = here.is_shared && (job.node != here.id || waits(job));
  if (is_known_elsewhere(job) || is_of_others) return;
  if (!waits(job)) return take_up(job, Found::lapsed);
  if (!events_.find(job.id)) wait_again(job);
}

/// A running job's end is settled by its worker.
void JobQueue::settle_doubt(const std::string& id) {
  if (running_.contains(id)) return;
  const std::optional<store::JobRecord> job = store_.find(id);
  doubted_.erase(id);
  if (!job) return blobs_.remove(id);
  const TraceScope trace(job->trace);
  if (api::is_final(job->state)) tell_end(*job);
}

}  // namespace unwrapd::server::jobs
