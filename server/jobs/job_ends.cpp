// The part of job_queue.hpp for the ends of jobs: stored first, then told.
#include <chrono>

#include "api/error_table.hpp"
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
  wait_or_end(job.record);
  return true;
}

/// The success that it is, if its files can be noted.
store::JobOutcome JobQueue::sealed(const std::string& id, store::JobOutcome outcome) {
  try {
    outcome.stored_bytes = blobs_.seal(id);
    return outcome;
  } catch (const Error& error) {
    return store::ended(JobState::failed, error, id);
  }
}

void JobQueue::finish(const RunningJob& job, store::JobOutcome outcome,
                      const std::function<void()>& stored) {
  if (outcome.state == JobState::succeeded) outcome = sealed(job.record.id, std::move(outcome));
  std::unique_lock lock(mutex_);
  const auto leave = [&] {
    running_.erase(job.record.id);
    changed_.notify_all();
    share_.end(job.record.owner, job.seconds());
  };
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
    wait_or_end(job.record);  // its readers are told so
    return;
  }
  if (wait_for_room(job, outcome)) return;
  end_job(job.record, outcome, stored);
}

void JobQueue::end_job(const store::JobRecord& job, store::JobOutcome outcome,
                       const std::function<void()>& stored) {
  const std::shared_ptr<JobFeed> feed = events_.find(job.id);
  outcome.last_event = feed->next_seq();
  const Moment now = store_.now();
  outcome.finished_ms = now.of_day_ms;
  outcome.set_by_ms = now.set_by_ms;
  store::JobRecord record = job;
  record.state = outcome.state;
  record.problem = outcome.problem;
  record.finished_ms = outcome.finished_ms;
  if (!job.webhook.empty()) outcome.delivery = store::text_of(api::to_json(store::to_job(record)));
  const bool is_doubted = doubted_.contains(job.id);
  const bool is_ours = noting_doubt(job.id, [&] { return store_.finish(job, outcome); });
  if (!is_ours && !(is_doubted && has_ended(job, outcome.state))) return;
  if (stored) stored();
  tell_end(record);
}

void JobQueue::tell_end(const store::JobRecord& job) {
  if (const std::shared_ptr<JobFeed> feed = events_.find(job.id))
    feed->publish([&](std::int64_t seq) { return api::final_event(seq, store::to_job(job)); });
  events_.retire(job.id);
  if (job.state != JobState::succeeded) blobs_.remove(job.id);
  log_.info("job ended", {{"job", job.id},
                          {"state", api::state_name(job.state)},
                          {"attempt", job.attempt},
                          {"problem", job.problem}});
}

/// Whether the store has this end of this attempt.
bool JobQueue::has_ended(const store::JobRecord& job, JobState state) {
  doubted_.insert(job.id);  // until that is read
  const std::optional<store::JobRecord> stored = store_.find(job.id);
  doubted_.erase(job.id);
  return stored && stored->attempt == job.attempt && stored->state == state;
}

}  // namespace unwrapd::server::jobs
