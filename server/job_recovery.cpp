// Of job_queue.hpp: the jobs that nobody works on any longer.
#include "server/clock.hpp"
#include "server/job_queue.hpp"
#include "server/queue_errors.hpp"
#include "server/trace.hpp"

namespace unwrapd::server {
namespace {

using api::JobState;

constexpr int kMaxCrashes = 3;
constexpr int kMaxCrashesApart = 10;  // where one that is to blame should end its own process alone

}  // namespace

void JobQueue::recover(bool tried_apart) {
  const std::lock_guard lock(mutex_);
  tried_apart_ = tried_apart;
  for (const JobRecord& job : store_.all(JobState::queued)) wait_again(job);
  for (const JobRecord& job : store_.all(JobState::running)) {
    const TraceScope trace(job.trace);
    events_.open(job.id, job.attempt);
    left_.push_back(job.id);
  }
  try {
    take_up_left();
  } catch (const Error& error) {  // what is done can be read and removed meanwhile
    if (error.code() != ErrorCode::storage_full) throw;
    log_.warning("the disk is full, jobs of the last process wait", {{"jobs", left_.size()}});
  }
}

void JobQueue::take_up_left() {
  for (; !left_.empty(); left_.pop_front()) {
    const std::optional<JobRecord> job = store_.find(left_.front());
    if (!job || job->state != JobState::running) continue;
    const int most = tried_apart_ ? kMaxCrashesApart : kMaxCrashes;
    take_up(*job, job->crashes + 1 >= most ? Found::too_often_by_death : Found::by_death);
  }
}

void JobQueue::take_up(const JobRecord& job, Found found) {
  const TraceScope trace(job.trace);
  if (job.cancel_requested) {
    give_up(job, cancelled_by_owner());
  } else if (found == Found::too_often_by_death) {
    give_up(job, poison());
  } else {
    store_.requeue(job.id, found == Found::by_death);
    wait_again(job);
    log_.warning("job found at nobody's hands, queued again",
                 {{"job", job.id}, {"attempt", job.attempt}});
  }
}

void JobQueue::give_up(const JobRecord& job, const Error& why) {
  if (!events_.find(job.id)) events_.open(job.id, job.attempt);
  const bool cancelled = why.code() == ErrorCode::cancelled;
  end_job(job, ended(cancelled ? JobState::cancelled : JobState::failed, why, job.id));
}

void JobQueue::beat() {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = elapsed_ms();
  for (const auto& [id, job] : running_) store_.renew(id, now + config_.lease.count());
  take_up_left();
  for (const JobRecord& job : store_.lapsed(now)) take_up(job, Found::lapsed);
}

}  // namespace unwrapd::server
