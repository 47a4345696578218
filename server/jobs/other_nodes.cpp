// The part of job_queue.hpp for a store that other nodes work on, too.
#include <chrono>
#include <thread>
#include <utility>

#include "server/base/errors.hpp"
#include "server/jobs/job_queue.hpp"

namespace unwrapd::server::jobs {
namespace {

constexpr std::chrono::seconds kTimeToInsert{30};  // the row of files that are there
constexpr std::chrono::milliseconds kPauseBetweenLooksAtFiles{50};
constexpr int kMostLooks = 60;
constexpr int kSecondsToArrive = 2;

RetryLater same_job_is_arriving() {
  return {ErrorCode::storage_failed,
          "Another request is sending the job of this id; try again after Retry-After.",
          kSecondsToArrive};
}

}  // namespace

void JobQueue::tell_others(std::function<void()> jobs_wait, std::function<void()> cancelled) {
  tell_jobs_wait_ = std::move(jobs_wait);
  tell_cancelled_ = std::move(cancelled);
}

/// Where another node has been sent a job of the same id at the same moment, that is returned as
/// soon as it has a row. Files without one are left by a node that died, if nobody has touched them
/// for a while.
std::optional<store::JobRecord> JobQueue::keep_files(const Submission& submission) {
  const store::JobRecord& job = submission.job;
  for (int look = 0; is_shared() && blobs_.holds(job.id); ++look) {
    if (std::optional<store::JobRecord> known = same_name(job)) {
      give_back(submission.sender);
      blobs_.drop_upload(submission.upload);
      return known;
    }
    if (blobs_.is_idle(job.id, kTimeToInsert)) {
      blobs_.set_aside(job.id, store_.now().kept_ms());
    } else if (look == kMostLooks) {
      throw same_job_is_arriving();
    } else {
      std::this_thread::sleep_for(kPauseBetweenLooksAtFiles);
    }
  }
  try {
    blobs_.keep_upload(submission.upload, job.id, store::digests_of(job.input));
  } catch (const Error&) {
    if (is_shared() && blobs_.holds(job.id)) throw same_job_is_arriving();
    throw;
  }
  return std::nullopt;
}

/// Of a request that another node has been sent at the same time.
store::JobRecord JobQueue::known_elsewhere(const store::JobRecord& job) {
  if (std::optional<store::JobRecord> known = same_name(job)) return std::move(*known);
  throw unknown_job();
}

/// Under the mutex, so that no worker is between its look and its wait.
void JobQueue::look_for_jobs() {
  const std::lock_guard lock(mutex_);
  changed_.notify_all();
}

/// Another node has taken the job up, or ended it; or this one has begun it again.
void JobQueue::leave_to_others(const store::JobRecord& job, JobFeed& feed) {
  if (!is_shared()) return;
  const auto now = running_.find(job.id);
  if (now == running_.end() || now->second->record.attempt == job.attempt) feed.follow(true);
  blobs_.drop_attempt(job.id, job.attempt);
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
