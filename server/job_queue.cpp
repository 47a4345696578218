#include "server/job_queue.hpp"

#include <algorithm>
#include <cmath>

#include "api/error_table.hpp"
#include "server/clock.hpp"

namespace unwrapd::server {
namespace {

using api::JobState;

constexpr int kMaxCrashes = 3;
constexpr double kMeanWeight = 0.2;  // of the newest job in the running mean of run times
constexpr int kDrainRetrySeconds = 5;

JobOutcome ended(JobState state, const Error& why, std::string_view job) {
  return {.state = state,
          .result_format = {},
          .problem = api::problem(why, job),
          .last_event = 0,
          .finished_ms = 0};
}

Error cancelled_by_owner() {
  return {ErrorCode::cancelled, "The job was cancelled; send it again to have it done."};
}

}  // namespace

void RunningJob::request_stop(StopCause why) {
  StopCause none = StopCause::none;
  cause.compare_exchange_strong(none, why);
  stop.request_stop();
}

JobQueue::JobQueue(JobStore& store, BlobStore& blobs, EventFeed& events, const Log& log,
                   const QueueConfig& config)
    : store_(store), blobs_(blobs), events_(events), log_(log), config_(config) {}

void JobQueue::recover() {
  const std::lock_guard lock(mutex_);
  for (const JobRecord& job : store_.all(JobState::running)) {
    if (job.cancel_requested) {
      give_up(job, cancelled_by_owner());
    } else if (job.crashes + 1 >= kMaxCrashes) {
      give_up(job, Error(ErrorCode::poison,
                         "The server ended three times while it worked on this job; it is not "
                         "tried again. Check the mesh, or send a smaller part of it."));
    } else {
      store_.requeue(job.id, true);
      log_.warning("job found running after a crash, queued again",
                   {{"job", job.id}, {"attempt", job.attempt}});
    }
  }
  for (const JobRecord& job : store_.all(JobState::queued)) wait_again(job);
}

void JobQueue::give_up(const JobRecord& job, const Error& why) {
  events_.open(job.id, job.attempt);
  const bool cancelled = why.code() == ErrorCode::cancelled;
  end_job(job, ended(cancelled ? JobState::cancelled : JobState::failed, why, job.id));
}

void JobQueue::wait_again(const JobRecord& job) {
  events_.open(job.id, job.attempt)->publish([&](std::int64_t seq) {
    return api::queued_event(seq, waiting_);
  });
  ++waiting_;
}

int JobQueue::retry_after_seconds() const {
  return std::max(1, static_cast<int>(std::ceil(mean_job_seconds_ / config_.workers)));
}

void JobQueue::check_room_locked() const {
  if (closed_) {
    throw RetryLater(ErrorCode::draining,
                     "The server is shutting down and takes no new jobs; send it again shortly.",
                     kDrainRetrySeconds);
  }
  if (waiting_ >= config_.max_queue) {
    throw RetryLater(ErrorCode::queue_full,
                     "All " + std::to_string(config_.max_queue) +
                         " places in the queue are taken; send the job again after Retry-After.",
                     retry_after_seconds());
  }
}

void JobQueue::check_room() {
  const std::lock_guard lock(mutex_);
  check_room_locked();
}

JobRecord JobQueue::submit(JobRecord job) {
  blobs_.keep_upload(job.id);
  try {
    enqueue(job);
  } catch (...) {
    blobs_.remove(job.id);
    throw;
  }
  changed_.notify_all();
  log_.info("job queued", {{"job", job.id}, {"bytes", job.input.bytes}});
  return job;
}

void JobQueue::enqueue(JobRecord& job) {
  const std::lock_guard lock(mutex_);
  check_room_locked();
  job.seq = store_.insert(job);
  wait_again(job);
}

std::shared_ptr<RunningJob> JobQueue::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || waiting_ > 0; });
  if (closed_) return nullptr;
  std::optional<JobRecord> record = store_.take_oldest();
  if (!record) throw Error(ErrorCode::internal, "The store has lost a queued job.");
  --waiting_;
  auto job = std::make_shared<RunningJob>();
  job->record = std::move(*record);
  job->feed = events_.find(job->record.id);
  job->started_ms = now_ms();
  running_[job->record.id] = job;
  job->feed->publish(
      [&](std::int64_t seq) { return api::started_event(seq, job->record.attempt); });
  return job;
}

void JobQueue::finish(const RunningJob& job, JobOutcome outcome) {
  const std::lock_guard lock(mutex_);
  running_.erase(job.record.id);
  changed_.notify_all();
  if (outcome.state == JobState::cancelled && job.cause == StopCause::draining) {
    store_.requeue(job.record.id, false);
    return;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - job.began;
  mean_job_seconds_ += kMeanWeight * (took.count() - mean_job_seconds_);
  end_job(job.record, std::move(outcome));
}

void JobQueue::end_job(const JobRecord& job, JobOutcome outcome) {
  const std::shared_ptr<JobFeed> feed = events_.find(job.id);
  outcome.last_event = feed->next_seq();
  outcome.finished_ms = now_ms();
  if (!store_.finish(job, outcome)) return;
  JobRecord record = job;
  record.state = outcome.state;
  record.problem = outcome.problem;
  feed->publish([&](std::int64_t seq) { return api::final_event(seq, to_job(record)); });
  events_.retire(job.id);
  if (outcome.state != JobState::succeeded) blobs_.remove(job.id);
  log_.info("job ended", {{"job", job.id},
                          {"state", api::state_name(outcome.state)},
                          {"attempt", job.attempt},
                          {"problem", outcome.problem}});
}

bool JobQueue::cancel_or_remove(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const std::optional<JobRecord> job = store_.find(id);
  if (!job) throw Error(ErrorCode::not_found, "There is no job of this id; check the address.");
  if (!api::is_final(job->state)) {
    cancel_live(*job);
    return true;
  }
  store_.remove(id);
  events_.forget(id);
  blobs_.remove(id);
  log_.info("job removed", {{"job", id}});
  return false;
}

void JobQueue::cancel_live(const JobRecord& job) {
  if (job.state == JobState::queued) {
    --waiting_;
    end_job(job, ended(JobState::cancelled, cancelled_by_owner(), job.id));
    return;
  }
  store_.request_cancel(job.id);
  const auto running = running_.find(job.id);
  if (running != running_.end()) running->second->request_stop(StopCause::cancelled);
}

void JobQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void JobQueue::drain(std::chrono::seconds patience) {
  close();
  std::unique_lock lock(mutex_);
  const auto idle = [&] { return running_.empty(); };
  if (changed_.wait_for(lock, patience, idle)) return;
  for (const auto& [id, job] : running_) {
    log_.warning("job interrupted by the shutdown, queued again", {{"job", id}});
    job->request_stop(StopCause::draining);
  }
  changed_.wait(lock, idle);
}

}  // namespace unwrapd::server
