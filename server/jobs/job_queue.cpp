#include "server/jobs/job_queue.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "api/error_table.hpp"
#include "server/base/clock.hpp"
#include "server/base/errors.hpp"
#include "server/base/trace.hpp"
#include "server/jobs/request_fingerprint.hpp"
#include "server/store/job_rows.hpp"

namespace unwrapd::server::jobs {
using api::JobState;

namespace {

constexpr std::chrono::milliseconds kPauseWhileTaken{5};
constexpr std::chrono::milliseconds kPauseWhileLeft{25};  // to a node that has worked on its mesh
constexpr std::chrono::seconds kPauseBetweenLooks{1};

/// Of an insertion that added nothing. Only where requests come to several nodes at a time: a quota
/// is checked before.
void check_added(store::Insertion::Outcome outcome, const http::Quota& quota) {
  using Outcome = store::Insertion::Outcome;
  if (outcome == Outcome::ticket_spent) throw ticket_spent();
  if (outcome == Outcome::too_many_jobs) throw too_many_jobs(quota.max_jobs, 1);
  if (outcome == Outcome::too_many_bytes) throw quota_exceeded(quota.max_bytes);
}

}  // namespace

JobQueue::JobQueue(store::JobStore& store, blobs::BlobStore& blobs, EventFeed& events,
                   const Log& log, const QueueConfig& config)
    : store_(store),
      blobs_(blobs),
      events_(events),
      log_(log),
      config_(config),
      door_(config.max_queue),
      all_workers_(config.workers),
      leases_(config.lease),
      sharing_(store, log, [this] {
        look_for_jobs();
        tell_jobs_wait_();
      }) {
  load_lengths();
}

void JobQueue::load_lengths() {
  lengths_ = {};
  std::vector<double> seconds = store_.last_lengths(Lengths::kRemembered);
  for (const double length : std::views::reverse(seconds)) lengths_.add(length);
}

/// Does not fail where the store is away: the job's row says already that it waits.
void JobQueue::wait_again(const store::JobRecord& job) {
  const TraceScope trace(job.trace);
  std::shared_ptr<JobFeed> feed = events_.find(job.id);  // with its readers, if it ran already
  if (!feed) feed = events_.open(job.id, job.attempt);
  if (is_shared()) feed->rise_to(job.attempt * kSeqsPerAttempt);
  const std::int64_t ahead = std::max<std::int64_t>(0, counts_if_reached().waiting - 1);
  feed->publish([&](std::int64_t seq) { return api::queued_event(seq, ahead); });
  feed->follow(is_shared());
  changed_.notify_all();
  tell_jobs_wait_();
}

void JobQueue::check_open() const {
  if (closed_) throw server::draining();
  if (const int seconds = pause_.seconds_left(); seconds > 0) throw no_room(seconds);
}

std::optional<RetryLater> JobQueue::shortage() const {
  const std::lock_guard lock(mutex_);
  if (left_.empty() && !(pause_.is_full() && store_.counts().waiting > 0)) return std::nullopt;
  return no_room(std::max(1, pause_.seconds_left()));
}

std::vector<AtWork> JobQueue::at_work() {
  std::vector<AtWork> all;
  for (const auto& [id, job] : running_) all.push_back({job->record.owner, job->seconds()});
  if (!is_shared()) return all;
  const std::int64_t now = now_ms();
  for (const store::JobRecord& job : store_.running(true)) {
    const auto ran_ms = static_cast<double>(std::max<std::int64_t>(0, now - job.started_ms));
    all.push_back({job.owner, ran_ms / kMsPerSecond});
  }
  return all;
}

QueueState JobQueue::state() {
  return {.counts = store_.counts(),
          .lengths = lengths_,
          .workers = all_workers_,
          .running = at_work()};
}

/// At least 1, as of lengths: turns go by what jobs cost, and without a cost they do not change.
std::int64_t JobQueue::mean_ms() const {
  return std::max<std::int64_t>(1, std::llround(lengths_.mean * kMsPerSecond));
}

void JobQueue::check_room(const Applicant& sender) {
  const std::lock_guard lock(mutex_);
  check_open();
  door_.check_place(sender, state());
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
  if (std::optional<store::JobRecord> known = keep_files(submission)) return std::move(*known);
  try {
    if (!enqueue(submission, submission.bypass_cache ? std::nullopt : find_answer(job))) {
      blobs_.remove(job.id);
      return known_elsewhere(job);
    }
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

/// False where another node has been sent the same request meanwhile.
bool JobQueue::enqueue(Submission& submission, const std::optional<Answer>& answer) {
  store::JobRecord& job = submission.job;
  const std::lock_guard lock(mutex_);
  check_open();
  const QueueState now = state();
  door_.check_place({.who = submission.sender, .owner = job.owner}, now);
  if (const http::Quota& quota = submission.quota; quota.max_jobs > 0 || quota.max_bytes > 0)
    door_.check_quota(submission.sender, quota, store_.usage(job.owner), job, now);
  door_.leave(submission.sender);
  give_up_excess();
  const store::Insertion added = noting_doubt(job.id, [&] {
    const http::Quota& quota = submission.quota;
    return store_.insert(job, {.live_jobs = quota.max_jobs, .stored_bytes = quota.max_bytes},
                         submission.ticket, now_ms());
  });
  if (added.outcome == store::Insertion::Outcome::known) return false;
  check_added(added.outcome, submission.quota);
  job.seq = added.seq;
  if (!answer || !answer_from_store(job, *answer)) wait_again(job);
  return true;
}

Turn JobQueue::take_turn(bool may_help) {
  std::unique_lock lock(mutex_);
  while (!closed_) {
    if (pause_.seconds_left() > 0) {
      changed_.wait_until(lock, pause_.until());
      continue;
    }
    const std::optional<std::string> owner = store_.next_owner(mean_ms());
    if (!owner) {
      if (may_help)
        if (std::shared_ptr<HelpedJob> helped = sharing_.find()) return {.helped = helped};
      await_news(lock);
      continue;
    }
    std::optional<store::JobRecord> record = take_of(*owner);
    if (!record) {
      changed_.wait_for(lock, store_.node().keeps_work ? kPauseWhileLeft : kPauseWhileTaken);
    } else if (record->unreadable.empty()) {
      return {.job = begin(std::move(*record))};
    } else {
      set_aside(*record);
    }
  }
  return {};
}

std::optional<store::JobRecord> JobQueue::take_of(const std::string& owner) {
  if (!store_.node().keeps_work) return store_.take(owner, now_ms());
  const auto chosen = affinity_.choose(store_.first_waiting(owner, Affinity::kLook),
                                       std::chrono::steady_clock::now());
  if (!chosen) return std::nullopt;
  std::optional<store::JobRecord> record = store_.take_one(chosen->seq, now_ms());
  if (record) affinity_.count(*chosen);
  return record;
}

/// What other nodes do is found by looking, even where no hint of it arrives.
void JobQueue::await_news(std::unique_lock<std::mutex>& lock) {
  if (is_shared()) {
    changed_.wait_for(lock, kPauseBetweenLooks);
  } else {
    changed_.wait(lock);
  }
}

std::shared_ptr<RunningJob> JobQueue::begin(store::JobRecord record) {
  auto job = std::make_shared<RunningJob>();
  job->record = std::move(record);
  const std::string& id = job->record.id;
  job->feed = events_.find(id);
  const std::chrono::milliseconds waited(
      std::max<std::int64_t>(0, job->record.started_ms - job->record.created_ms));
  if (!job->feed) job->feed = events_.open(id, job->record.attempt - 1, waited);
  job->feed->follow(false);
  if (is_shared()) job->feed->rise_to((job->record.attempt - 1) * kSeqsPerAttempt + kSeqsOfRun);
  job->started_ms = job->record.started_ms;
  std::shared_ptr<RunningJob>& running = running_[id];
  if (running) running->request_stop(StopCause::lost);  // taken from this node, and now given back
  running = job;
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
    bool is_ended = false;
    blobs_.room().free_by([&] {
      is_ended = end_job(job, store::ended(JobState::cancelled, cancelled_by_owner(), job.id));
    });
    std::erase(left_, job.id);
    if (is_ended) return;  // else another node has begun it meanwhile
  }
  blobs_.room().free_by([&] { store_.request_cancel(job.id); });
  const auto running = running_.find(job.id);
  if (running != running_.end()) return running->second->request_stop(StopCause::cancelled);
  tell_cancelled_();
}

void JobQueue::note_process_end(const RunningJob& job) {
  try {
    store_.note_process_end(job.record.id);
  } catch (const StoreAway&) {    // it counts as long as this server runs
  } catch (const Error& error) {  // the job goes on
    if (error.code() != ErrorCode::storage_full) throw;
  }
}

}  // namespace unwrapd::server::jobs
