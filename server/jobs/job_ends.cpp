// The part of job_queue.hpp for the ends of jobs: stored first, then told.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "api/error_table.hpp"
#include "server/base/clock.hpp"
#include "server/base/errors.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/store/job_rows.hpp"

namespace unwrapd::server::jobs {
namespace {

using api::JobState;

constexpr int kMaxAttemptsWhenFull = 20;
constexpr std::chrono::milliseconds kPauseWhileAway{500};

}  // namespace

/// Whether a job whose results found no room waits until there is some.
bool JobQueue::wait_for_room(const RunningJob& job, const store::JobOutcome& outcome) {
  const bool full = outcome.state == JobState::failed &&
                    api::error_from_problem(outcome.problem).code() == ErrorCode::storage_full;
  const bool again = full && !closed_ && job.record.attempt < kMaxAttemptsWhenFull;
  pause_.note(again);
  if (!again) return false;
  log_.warning("the disk is full, the job waits", {{"job", job.record.id}});
  wait_or_end(job.record, outcome.ran_ms);
  return true;
}

/// The success that it is, if its files can be noted. Throws StoreAway while the server ends.
store::JobOutcome JobQueue::sealed(const store::JobRecord& job, store::JobOutcome outcome) {
  while (true) {
    try {
      outcome.stored_bytes = blobs_.seal(job.id, job.attempt);
      return outcome;
    } catch (const StoreAway& away) {
      log_.warning("the results of a job wait for the bucket",
                   {{"job", job.id}, {"reason", reason_of(away)}});
      if (closed_) throw;
    } catch (const Error& error) {
      return store::ended(JobState::failed, error, job.id);
    }
    std::this_thread::sleep_for(kPauseWhileAway);
  }
}

void JobQueue::finish(const RunningJob& job, store::JobOutcome outcome,
                      const std::function<void()>& stored) {
  std::unique_lock lock(mutex_, std::defer_lock);
  const auto leave = [&] {
    const auto now = running_.find(job.record.id);
    if (now != running_.end() && now->second.get() == &job) running_.erase(now);
    changed_.notify_all();
    lengths_.add(job.seconds());
  };
  try {
    if (outcome.state == JobState::succeeded) outcome = sealed(job.record, std::move(outcome));
  } catch (const StoreAway&) {  // it is run again
    lock.lock();
    return leave();
  }
  lock.lock();
  outcome.ran_ms = std::max<std::int64_t>(1, std::llround(job.seconds() * kMsPerSecond));
  while (true) {
    try {
      settle_end(job, outcome, stored);
      return leave();
    } catch (const StoreAway& away) {
      log_.warning("the end of a job waits for the store",
                   {{"job", job.record.id}, {"reason", reason_of(away)}});
    } catch (...) {
      leave();
      throw;
    }
    if (closed_) return leave();  // the next start runs it again, unless its end is stored
    changed_.wait_for(lock, kPauseWhileAway);
  }
}

void JobQueue::settle_end(const RunningJob& job, const store::JobOutcome& outcome,
                          const std::function<void()>& stored) {
  if (outcome.state == JobState::cancelled && job.cause == StopCause::draining) {
    wait_or_end(job.record, outcome.ran_ms);  // its readers are told so
    return;
  }
  if (wait_for_room(job, outcome)) return;
  end_job(job.record, outcome, stored);
}

bool JobQueue::end_job(const store::JobRecord& job, store::JobOutcome outcome,
                       const std::function<void()>& stored) {
  std::shared_ptr<JobFeed> feed = events_.find(job.id);
  if (!feed) feed = events_.open(job.id, job.attempt);
  if (is_shared() && !running_.contains(job.id)) {
    feed->follow(false);
    feed->rise_to(job.attempt * kSeqsPerAttempt + kSeqsOfEnds);
  }
  outcome.last_event = feed->next_seq();
  const Moment now = store_.now();
  outcome.finished_ms = now.of_day_ms;
  outcome.set_by_ms = now.set_by_ms;
  store::JobRecord record = job;
  record.state = outcome.state;
  record.problem = outcome.problem;
  record.finished_ms = outcome.finished_ms;
  if (!job.webhook.empty()) outcome.delivery = api::to_text(api::to_json(store::to_job(record)));
  const bool is_doubted = doubted_.contains(job.id);
  const bool is_ours = noting_doubt(job.id, [&] { return store_.finish(job, outcome); });
  if (!is_ours && !(is_doubted && has_ended(job, outcome.state))) {
    leave_to_others(job, *feed);
    return false;
  }
  if (stored) stored();
  tell_end(record);
  return true;
}

void JobQueue::tell_end(const store::JobRecord& job) {
  if (job.state == JobState::succeeded) publish(job);
  if (const std::shared_ptr<JobFeed> feed = events_.find(job.id))
    feed->publish([&](std::int64_t seq) { return api::final_event(seq, store::to_job(job)); });
  events_.retire(job.id);
  if (job.state != JobState::succeeded) blobs_.remove(job.id);
  log_.info("job ended", {{"job", job.id},
                          {"state", api::state_name(job.state)},
                          {"attempt", job.attempt},
                          {"problem", job.problem}});
}

/// What fails here is done by the first node that finds the job (JobStore::on_found()).
void JobQueue::publish(const store::JobRecord& job) {
  try {
    blobs_.publish(job.id, job.attempt);
  } catch (const std::exception& error) {
    log_.warning("results are not in their place yet",
                 {{"job", job.id}, {"reason", reason_of(error)}});
  }
}

/// Whether the store has this end of this attempt.
bool JobQueue::has_ended(const store::JobRecord& job, JobState state) {
  doubted_.insert(job.id);  // until that is read
  const std::optional<store::JobRecord> stored = store_.find(job.id);
  doubted_.erase(job.id);
  return stored && stored->attempt == job.attempt && stored->state == state;
}

}  // namespace unwrapd::server::jobs
