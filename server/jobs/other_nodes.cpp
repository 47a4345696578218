// The part of job_queue.hpp for a store that other nodes work on, too.
#include <utility>

#include "server/jobs/job_queue.hpp"

namespace unwrapd::server::jobs {

void JobQueue::tell_others(std::function<void()> jobs_wait, std::function<void()> cancelled) {
  tell_jobs_wait_ = std::move(jobs_wait);
  tell_cancelled_ = std::move(cancelled);
}

void JobQueue::stop_cancelled() {
  const std::lock_guard lock(mutex_);
  if (running_.empty()) return;
  for (const std::string& id : store_.cancelled_here())
    if (const auto job = running_.find(id); job != running_.end())
      job->second->request_stop(StopCause::cancelled);
}

void JobQueue::tell_end_elsewhere(const std::string& id) {
  const std::shared_ptr<JobFeed> feed = events_.find(id);
  if (!feed) return;
  const std::optional<store::JobRecord> job = store_.find(id);
  if (job && !api::is_final(job->state)) return;
  if (job) {
    feed->append({.job = id,
                  .seq = job->last_event,
                  .is_last = true,
                  .frame = api::sse_frame(api::final_event(job->last_event, store::to_job(*job))),
                  .progress = {}});
  }
  feed->end();  // of a job that is gone; nothing where it has its last event
  events_.retire(id);
}

}  // namespace unwrapd::server::jobs
