#include "server/jobs/job_queue.hpp"

#include "api/error_table.hpp"
#include "server/base/clock.hpp"
#include "server/base/errors.hpp"
#include "server/base/trace.hpp"
#include "server/jobs/request_fingerprint.hpp"
#include "server/store/job_rows.hpp"

namespace unwrapd::server::jobs {
using api::JobState;

JobQueue::JobQueue(store::JobStore& store, store::BlobStore& blobs, EventFeed& events,
                   const Log& log, const QueueConfig& config)
    : store_(store),
      blobs_(blobs),
      events_(events),
      log_(log),
      config_(config),
      door_(config.max_queue, config.workers) {}

void JobQueue::wait_again(const store::JobRecord& job) {
  const TraceScope trace(job.trace);
  std::shared_ptr<JobFeed> feed = events_.find(job.id);  // with its readers, if it ran already
  if (!feed) feed = events_.open(job.id, job.attempt);
  feed->publish([&](std::int64_t seq) { return api::queued_event(seq, share_.waiting()); });
  share_.add(job.owner);
  changed_.notify_all();
}

void JobQueue::check_open() const {
  if (closed_) throw server::draining();
  if (const int seconds = pause_.seconds_left(); seconds > 0) throw no_room(seconds);
}

std::optional<RetryLater> JobQueue::shortage() const {
  const std::lock_guard lock(mutex_);
  if (left_.empty() && !(pause_.is_full() && share_.waiting() > 0)) return std::nullopt;
  return no_room(std::max(1, pause_.seconds_left()));
}

std::vector<AtWork> JobQueue::at_work() const {
  std::vector<AtWork> all;
  for (const auto& [id, job] : running_) all.push_back({job->record.owner, job->seconds()});
  return all;
}

void JobQueue::check_room(const Applicant& sender) {
  const std::lock_guard lock(mutex_);
  check_open();
  door_.check_place(sender, share_, at_work());
}

void JobQueue::give_back(std::string_view sender) {
  const std::lock_guard lock(mutex_);
  door_.leave(sender);
}

std::optional<store::JobRecord> JobQueue::same_name(const store::JobRecord& job) {
  if (job.request_key.empty()) return std::nullopt;
  const std::lock_guard lock(mutex_);  // what is being removed is gone with its files
  std::optional<store::JobRecord> known = store_.find_request(job.owner, job.request_key);
  if (!known) known = store_.find(job.id);
  if (!known && doubted_.erase(job.id) > 0) blobs_.remove(job.id);  // it was not stored
  if (known && known->owner != job.owner) throw unknown_job();
  if (known && !is_same_request(*known, job)) throw another_question();
  return known;
}

store::JobRecord JobQueue::submit(Submission submission) {
  store::JobRecord& job = submission.job;
  std::unique_lock named(naming_, std::defer_lock);
  if (!job.request_key.empty()) named.lock();
  if (std::optional<store::JobRecord> known = same_name(job)) {
    give_back(submission.sender);
    blobs_.drop_upload(submission.upload);
    return std::move(*known);
  }
  blobs_.keep_upload(submission.upload, job.id, store::digests_of(job.input));
  try {
    enqueue(job, submission, submission.bypass_cache ? std::nullopt : find_answer(job));
  } catch (const StoreAway& away) {
    if (!away.in_doubt()) blobs_.remove(job.id);
    throw;
  } catch (...) {
    blobs_.remove(job.id);
    throw;
  }
  log_.info("job queued", {{"job", job.id}, {"bytes", job.input.bytes}});
  return std::move(job);
}

void JobQueue::enqueue(store::JobRecord& job, const Submission& submission,
                       const std::optional<Answer>& answer) {
  const std::lock_guard lock(mutex_);
  check_open();
  door_.check_place({.who = submission.sender, .owner = job.owner}, share_, at_work());
  if (const http::Quota& quota = submission.quota; quota.max_jobs > 0 || quota.max_bytes > 0)
    door_.check_quota(submission.sender, quota, store_.usage(job.owner), job, share_, at_work());
  door_.leave(submission.sender);
  give_up_excess();
  job.seq = noting_doubt(job.id, [&] { return insert(job, submission.ticket); });
  if (!answer || !answer_from_store(job, *answer)) wait_again(job);
}

std::int64_t JobQueue::insert(const store::JobRecord& job,
                              const std::optional<store::SpentTicket>& ticket) {
  if (!ticket) return store_.insert(job);
  const std::optional<std::int64_t> seq = store_.insert(job, *ticket, now_ms());
  if (!seq) throw ticket_spent();
  return *seq;
}

/// False when the queue is closed.
bool JobQueue::await_turn(std::unique_lock<std::mutex>& lock) {
  while (!closed_) {
    if (share_.waiting() == 0) {
      changed_.wait(lock);
    } else if (pause_.seconds_left() > 0) {
      changed_.wait_until(lock, pause_.until());
    } else {
      return true;
    }
  }
  return false;
}

/// A job whose row cannot be read never runs.
std::shared_ptr<RunningJob> JobQueue::take() {
  std::unique_lock lock(mutex_);
  while (await_turn(lock)) {
    const std::string owner = share_.next();
    std::optional<store::JobRecord> record =
        store_.take(owner, elapsed_ms() + config_.lease.count());
    if (record && record->unreadable.empty()) return begin(std::move(*record));
    share_.remove(owner);
    if (record) {
      set_aside(*record);
    } else {
      log_.error("the store has lost a queued job", {{"owner", owner}});
    }
  }
  return nullptr;
}

std::shared_ptr<RunningJob> JobQueue::begin(store::JobRecord record) {
  share_.start(record.owner);
  auto job = std::make_shared<RunningJob>();
  job->record = std::move(record);
  job->feed = events_.find(job->record.id);
  job->started_ms = now_ms();
  running_[job->record.id] = job;
  job->feed->publish(
      [&](std::int64_t seq) { return api::started_event(seq, job->record.attempt); });
  return job;
}

bool JobQueue::cancel_or_remove(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const std::optional<store::JobRecord> job = store_.find(id);
  if (!job) throw unknown_job();
  if (!api::is_final(job->state)) {
    cancel_live(*job);
    return true;
  }
  remove_ended(id);
  log_.info("job removed", {{"job", id}});
  return false;
}

void JobQueue::remove_ended(const std::string& id) {
  blobs_.room().free_by([&] { store_.remove(id); });
  events_.forget(id);
  blobs_.remove(id);
}

void JobQueue::cancel_live(const store::JobRecord& job) {
  if (job.state == JobState::queued) {
    blobs_.room().free_by(
        [&] { end_job(job, store::ended(JobState::cancelled, cancelled_by_owner(), job.id)); });
    if (std::erase(left_, job.id) == 0) share_.remove(job.owner);
    return;
  }
  blobs_.room().free_by([&] { store_.request_cancel(job.id); });
  const auto running = running_.find(job.id);
  if (running != running_.end()) running->second->request_stop(StopCause::cancelled);
}

void JobQueue::note_process_end(const RunningJob& job) {
  try {
    store_.note_process_end(job.record.id);
  } catch (const StoreAway&) {    // it counts as long as this server runs
  } catch (const Error& error) {  // the job goes on
    if (error.code() != ErrorCode::storage_full) throw;
  }
}

void JobQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void JobQueue::stop_waiting() {
  const std::lock_guard lock(mutex_);
  hurried_ = true;
  changed_.notify_all();
}

bool JobQueue::drain(std::chrono::seconds patience) {
  close();
  std::unique_lock lock(mutex_);
  const auto idle = [&] { return running_.empty(); };
  changed_.wait_for(lock, patience, [&] { return idle() || hurried_; });
  if (idle()) return true;
  for (const auto& [id, job] : running_) {
    log_.warning("job interrupted by the shutdown, queued again", {{"job", id}});
    job->request_stop(StopCause::draining);
  }
  if (changed_.wait_for(lock, config_.stop, idle)) return true;
  for (const auto& [id, job] : running_) take_up_stuck(id);
  return false;
}

void JobQueue::take_up_stuck(const std::string& id) {
  try {
    const std::optional<store::JobRecord> stored = store_.find(id);
    if (stored && stored->state == JobState::running) take_up(*stored, Found::not_stopping);
  } catch (const Error& error) {  // the next start finds it
    log_.warning("job that does not stop could not be queued again",
                 {{"job", id}, {"reason", reason_of(error)}});
  }
}

}  // namespace unwrapd::server::jobs
