// The part of job_queue.hpp for a store that could not be reached for a while: what this queue
// knows and what the rows say is made the same again.
#include <algorithm>

#include "server/base/trace.hpp"
#include "server/jobs/job_queue.hpp"

namespace unwrapd::server::jobs {

using api::JobState;

void JobQueue::mend() {
  if (!store_.was_away()) return;
  const std::lock_guard lock(mutex_);
  const std::vector<store::JobRecord> unfinished = store_.unfinished();
  share_.forget_waiting();
  for (const store::JobRecord& job : unfinished) mend_waiting(job);
  const std::set<std::string> doubted = doubted_;
  for (const std::string& id : doubted) settle_doubt(id);
  log_.info("the store is reached again", {{"unfinished", unfinished.size()}});
}

/// A job that runs in the store alone was taken by a call that never heard of it.
void JobQueue::mend_waiting(const store::JobRecord& job) {
  if (running_.contains(job.id) || std::ranges::find(left_, job.id) != left_.end()) return;
  const bool waits =
      job.unreadable.empty() && job.state == JobState::queued && !job.cancel_requested;
  if (!waits) return take_up(job, Found::lapsed);
  if (!events_.find(job.id)) return wait_again(job);
  share_.add(job.owner);
  changed_.notify_all();
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
