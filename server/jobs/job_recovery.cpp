// The part of job_queue.hpp for jobs that no worker runs any longer.
#include <algorithm>

#include "server/base/clock.hpp"
#include "server/base/errors.hpp"
#include "server/base/trace.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/store/job_rows.hpp"

namespace unwrapd::server::jobs {
namespace {

using api::JobState;

constexpr std::int64_t kMostGivenUp = 64;
constexpr int kMaxCrashes = 3;
constexpr int kMaxCrashesApart = 10;  // where one that is to blame should end its own process alone

}  // namespace

void JobQueue::recover(bool tried_apart) {
  const std::lock_guard lock(mutex_);
  tried_apart_ = tried_apart;
  const store::Node& here = store_.node();
  if (is_shared()) store_.forget_own_work();
  for (const store::JobRecord& job : is_shared() ? store_.running() : store_.unfinished()) {
    if (is_shared() && job.node != here.id) continue;
    const bool is_whole = job.unreadable.empty();
    if (is_whole && job.state == JobState::queued && !job.cancel_requested) {
      wait_again(job);
      continue;
    }
    const TraceScope trace(job.trace);
    if (is_whole) events_.open(job.id, job.attempt);
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
    const std::optional<store::JobRecord> job = store_.find(left_.front());
    if (!job || (job->unreadable.empty() && api::is_final(job->state))) continue;
    take_up(*job, Found::by_death);
  }
}

/// Whether a job is to blame for deaths of the server. That it did not stop counts as one.
bool JobQueue::is_poison(const store::JobRecord& job, Found found) const {
  if (found == Found::lapsed) return false;
  return job.crashes + 1 >= (tried_apart_ ? kMaxCrashesApart : kMaxCrashes);
}

void JobQueue::take_up(const store::JobRecord& job, Found found) {
  const TraceScope trace(job.trace);
  if (!job.unreadable.empty()) {
    set_aside(job);
  } else if (job.cancel_requested) {
    give_up(job, cancelled_by_owner());
  } else if (is_poison(job, found)) {
    give_up(job, poison());
  } else if (store_.requeue(job, found != Found::lapsed)) {
    wait_again(job);
    log_.warning(found == Found::not_stopping
                     ? "job that does not stop queued again, under suspicion"
                     : "job without a worker found, queued again",
                 {{"job", job.id}, {"attempt", job.attempt}});
  }
}

/// Puts a running job back into the queue, unless its owner has cancelled it meanwhile.
void JobQueue::wait_or_end(const store::JobRecord& job, std::int64_t ran_ms) {
  const std::optional<store::JobRecord> stored = store_.find(job.id);
  if (!stored || stored->attempt != job.attempt) return;  // another node has taken it up
  if (stored->cancel_requested) return give_up(job, cancelled_by_owner());
  if (store_.requeue(*stored, false, ran_ms)) wait_again(job);
}

void JobQueue::give_up(const store::JobRecord& job, const Error& why) {
  if (!events_.find(job.id)) events_.open(job.id, job.attempt);
  const bool cancelled = why.code() == ErrorCode::cancelled;
  end_job(job, store::ended(cancelled ? JobState::cancelled : JobState::failed, why, job.id));
}

/// Moves its folder to lost. The job counts as failed, so that it neither waits nor runs.
void JobQueue::set_aside(const store::JobRecord& unreadable) {
  const Moment now = store_.now();
  store::JobOutcome outcome = store::ended(JobState::failed, unreadable_job(), unreadable.id);
  outcome.finished_ms = now.of_day_ms;
  outcome.set_by_ms = now.set_by_ms;
  store::JobRecord ended = unreadable;
  ended.finished_ms = outcome.finished_ms;
  if (!unreadable.webhook.empty())
    outcome.delivery = api::to_text(api::to_json(store::to_job(ended)));
  store_.set_aside(unreadable, outcome);
  const bool has_files = blobs_.set_aside(unreadable.id, now.kept_ms());
  log_.error("job set aside: its row cannot be read", {{"job", unreadable.id},
                                                       {"seq", unreadable.seq},
                                                       {"reason", unreadable.unreadable},
                                                       {"files", has_files ? "lost" : "none"}});
}

/// Removes a few at a time, as the queue is locked meanwhile. A lowered bound is met step by step.
void JobQueue::give_up_excess() {
  if (config_.max_stored == 0) return;
  const store::QueueCounts now = store_.counts();
  std::int64_t excess = store_.job_count() - now.waiting - now.running - config_.max_stored;
  for (excess = std::min(excess, kMostGivenUp); excess > 0; --excess) {
    const std::optional<std::string> first = store_.first_to_go();
    if (!first) return;
    remove_ended(*first);
    log_.info("job dropped, more are stored than --max-stored-jobs", {{"job", *first}});
  }
}

void JobQueue::renew_leases() {
  const std::lock_guard lock(mutex_);
  if (is_shared()) {
    all_workers_ = store_.announce(config_.workers);
    load_lengths();
  }
  prolong_own();
  take_up_left();
  take_up_lapsed();
  give_up_excess();
  store_.level_shares();
  store_.drop_ended_shared_work();
  if (store_.node().keeps_work) store_.forget_old_work();
}

/// A job that another node has taken up meanwhile stops here: its end would count for nothing.
void JobQueue::prolong_own() {
  for (const auto& [id, job] : running_)
    if (!store_.beat(job->record) && is_shared()) job->request_stop(StopCause::lost);
}

void JobQueue::take_up_lapsed() {
  for (const store::JobRecord& job : leases_.lapsed(store_.running(), LeaseWatch::Clock::now())) {
    const bool was_elsewhere = is_shared() && job.node != store_.node().id;
    if (!running_.contains(job.id)) take_up(job, was_elsewhere ? Found::by_death : Found::lapsed);
  }
}

}  // namespace unwrapd::server::jobs
