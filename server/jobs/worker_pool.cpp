#include "server/jobs/worker_pool.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <stop_token>
#include <thread>
#include <utility>

#include "api/error_table.hpp"
#include "server/base/errors.hpp"
#include "server/base/threads.hpp"
#include "server/base/trace.hpp"
#include "server/jobs/feed_output.hpp"
#include "server/store/stored_input.hpp"
#include "server/work/thread_executor.hpp"

namespace unwrapd::server::jobs {
namespace {

using api::JobState;

constexpr std::chrono::seconds kPauseAfterFailure{1};
constexpr int kMaxProcessEnds = 3;
constexpr std::chrono::seconds kTimeToKill{10};  // a process, and to reap it

/// A job stopped by its time limit has failed; one stopped by its owner, or by the end of the
/// server, was cancelled.
store::JobOutcome outcome_of(const Error& error, const RunningJob& job, int max_seconds) {
  if (error.code() != ErrorCode::cancelled)
    return store::ended(JobState::failed, error, job.record.id);
  if (job.cause != StopCause::time_limit)
    return store::ended(JobState::cancelled, error, job.record.id);
  const Error late(ErrorCode::time_limit, "The job took longer than the " +
                                              std::to_string(max_seconds) +
                                              " s allowed; ask for fewer iterations, or send a "
                                              "smaller mesh.");
  return store::ended(JobState::failed, late, job.record.id);
}

/// Asks a job to stop when its time is up, and gives it up when it does not stop then. Watches
/// while it exists. Each function is called at most once, by a thread of its own.
class Watchdog {
 public:
  struct Limits {
    std::chrono::seconds time;
    std::chrono::seconds grace;     ///< from the stop
    std::function<void()> late;     ///< after `time`; asks for the stop
    std::function<void()> overdue;  ///< when the job still runs at the end of its grace
  };

  /// stop: the token of the job; others may ask for the stop, too.
  Watchdog(const std::stop_token& stop, Limits limits)
      : stop_(stop),
        watch_(
            [this, limits = std::move(limits)](const std::stop_token& end) { watch(end, limits); }),
        wake_at_stop_(stop, [this] {
          const std::lock_guard lock(mutex_);
          wake_.notify_all();
        }) {}

 private:
  void watch(const std::stop_token& end, const Limits& limits) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, end, limits.time, [&] { return stop_.stop_requested(); });
    }
    if (end.stop_requested()) return;
    if (!stop_.stop_requested()) limits.late();
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, end, limits.grace, [] { return false; });
    }
    if (!end.stop_requested()) limits.overdue();
  }

  const std::stop_token stop_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watch_;                                      // it uses the others
  std::stop_callback<std::function<void()>> wake_at_stop_;  // last: it wakes the thread
};

}  // namespace

/// The resources of a run.
struct WorkerPool::Means {
  Executor& executor;
  store::QuotaReservation& reservation;
};

WorkerPool::WorkerPool(JobQueue& queue, blobs::BlobStore& blobs, const api::Limits& limits,
                       const Log& log, const WorkerConfig& config)
    : queue_(queue), blobs_(blobs), limits_(limits), log_(log), config_(config) {
  const std::lock_guard lock(mutex_);
  for (int worker = 0; worker < config.workers; ++worker) begin_thread();
}

/// A thread that ends now takes the mutex, so that it is not held while the threads are joined.
WorkerPool::~WorkerPool() {
  Threads threads;
  const std::lock_guard lock(mutex_);
  threads.swap(threads_);
}

int WorkerPool::lost() const {
  const std::lock_guard lock(mutex_);
  return lost_;
}

bool WorkerPool::are_left() const {
  const std::lock_guard lock(mutex_);
  return config_.workers == 0 || lost_ < config_.workers + replaced_;
}

/// Requires the mutex.
void WorkerPool::begin_thread() {
  threads_.emplace_back([this] { work(); });
}

void WorkerPool::work() {
  give_way();
  work::ThreadExecutor executor(config_.threads, config_.core);
  while (true) {
    try {
      const Turn turn = queue_.take_turn(config_.isolation.on);
      if (turn.helped) {
        help_with(*turn.helped);
      } else if (!turn.job || work_on(*turn.job, executor) == Then::leave) {
        return;
      }
    } catch (const std::exception& error) {  // the store: the job is run again at the next start
      log_.error("a worker failed", {{"reason", reason_of(error)}});
      std::this_thread::sleep_for(kPauseAfterFailure);
    }
  }
}

WorkerPool::Then WorkerPool::work_on(RunningJob& job, Executor& executor) {
  const TraceScope trace(job.feed->trace());
  log_.info("job started", {{"job", job.record.id}, {"attempt", job.record.attempt}});
  store::QuotaReservation reservation(*config_.reservations,
                                      job.record.owner);  // until the store counts the results
  const auto to_kill = is_apart(job.record) ? kTimeToKill : std::chrono::seconds(0);
  store::JobOutcome outcome;
  {
    const Watchdog watchdog(job.stop.get_token(),
                            {.time = std::chrono::seconds(limits_.max_job_seconds),
                             .grace = config_.isolation.grace + to_kill,
                             .late = [&] { job.request_stop(StopCause::time_limit); },
                             .overdue = [&] { give_up(job, reservation); }});
    outcome = attempt(job, {executor, reservation});
  }
  if (!job.take_end()) return come_back(job);
  queue_.finish(job, std::move(outcome), [&] { reservation.give_up(); });
  return Then::next_job;
}

/// Whether the job runs in a process of its own.
bool WorkerPool::is_apart(const store::JobRecord& job) const {
  const bool has_crashed = job.crashes > 0 || job.process_ends > 0;
  return config_.isolation.on || (has_crashed && config_.isolation.possible);
}

/// Called by the watchdog's thread for a job whose thread does not react to its stop. While the
/// server ends, JobQueue::drain() does this.
void WorkerPool::give_up(RunningJob& job, store::QuotaReservation& reservation) {
  if (job.cause == StopCause::draining || !job.take_end()) return;
  const TraceScope trace(job.feed->trace());
  lose_thread(job);
  config_.on_force("given_up");
  try {
    queue_.finish(job, outcome_of(job_stopped(), job, limits_.max_job_seconds),
                  [&] { reservation.give_up(); });
  } catch (const std::exception& error) {  // the store: the job is run again at the next start
    log_.error("a worker failed", {{"reason", reason_of(error)}});
  }
}

void WorkerPool::lose_thread(const RunningJob& job) {
  const std::lock_guard lock(mutex_);
  ended_.clear();
  ++lost_;
  const bool has_heir = replaced_ < config_.workers;
  if (has_heir) {
    ++replaced_;
    begin_thread();
  }
  log_.error("a job does not stop, and is given up", {{"job", job.record.id},
                                                      {"seconds", job.seconds()},
                                                      {"threads_lost", lost_},
                                                      {"replaced", has_heir}});
}

/// Called by a thread whose job was given up meanwhile: it takes jobs again unless it was replaced.
WorkerPool::Then WorkerPool::come_back(const RunningJob& job) {
  const std::lock_guard lock(mutex_);
  --lost_;
  log_.warning("a job that was given up has stopped",
               {{"job", job.record.id}, {"seconds", job.seconds()}, {"threads_lost", lost_}});
  if (replaced_ <= lost_) return Then::next_job;
  --replaced_;
  const auto self = std::ranges::find(threads_, std::this_thread::get_id(), &std::jthread::get_id);
  if (self != threads_.end()) ended_.splice(ended_.end(), threads_, self);
  return Then::leave;
}

/// Waits for a bucket that is away.
store::LoadedInput WorkerPool::load(const RunningJob& job) const {
  while (true) {
    try {
      return {blobs_, job.record};
    } catch (const StoreAway& away) {
      if (job.stop.stop_requested()) throw job_stopped();
      log_.warning("a job waits for its files",
                   {{"job", job.record.id}, {"reason", reason_of(away)}});
    }
    std::this_thread::sleep_for(kPauseAfterFailure);
  }
}

std::string WorkerPool::run(const RunningJob& job, const Means& means) {
  const store::LoadedInput loaded = load(job);
  FeedOutput output(job, blobs_, {means.reservation, config_.most_bytes});
  const auto queue_ms = static_cast<double>(job.started_ms - job.record.created_ms);
  work::JobTask task{.record = loaded.record(),
                     .queue_ms = std::max(0.0, queue_ms),
                     .began = job.began,
                     .stop = job.stop.get_token()};
  if (!is_apart(job.record))
    return config_.functions.run(task, loaded.input(), output, limits_, means.executor);
  work::Isolation isolation = config_.isolation;
  isolation.on_kill = [&] {
    log_.error("a job does not stop, and its process is killed",
               {{"job", job.record.id}, {"seconds", job.seconds()}});
    config_.on_force("killed");
  };
  std::unique_ptr<work::WorkDesk> desk;
  if (queue_.has_helpers()) desk = queue_.sharing().desk_of_job(job.record, job.stop.get_token());
  task.desk = desk.get();
  try {
    return work::run_job_isolated(task, loaded.input(), output, limits_, isolation);
  } catch (const Error& error) {
    const bool asked = error.code() != ErrorCode::cancelled || job.stop.stop_requested();
    if (!asked) throw work::WorkerCrashed("another party stopped it");
    throw;
  }
}

/// Runs the job again after a crash, which may have been an accident (the memory of the machine, an
/// operator). Crashes under earlier servers count.
std::string WorkerPool::run_patiently(const RunningJob& job, const Means& means) {
  for (int crashes = job.record.process_ends; crashes < kMaxProcessEnds;) {
    try {
      return run(job, means);
    } catch (const work::WorkerCrashed& crash) {
      ++crashes;
      queue_.note_process_end(job);
      log_.warning("a worker process ended",
                   {{"job", job.record.id}, {"how", crash.what()}, {"crashes", crashes}});
    }
  }
  throw too_many_crashes();
}

store::JobOutcome WorkerPool::attempt(const RunningJob& job, const Means& means) {
  try {
    store::JobOutcome outcome;
    outcome.result_format = run_patiently(job, means);
    return outcome;
  } catch (const Error& error) {
    return outcome_of(error, job, limits_.max_job_seconds);
  } catch (const std::bad_alloc&) {
    const Error error(ErrorCode::memory_limit,
                      "The server has too little memory for this job; send a smaller mesh.");
    return store::ended(JobState::failed, error, job.record.id);
  } catch (const std::exception& error) {  // the owner learns nothing of our insides
    log_.error("unhandled exception", {{"job", job.record.id}, {"reason", reason_of(error)}});
    return store::ended(JobState::failed, Error(ErrorCode::internal, "An internal error occurred."),
                        job.record.id);
  }
}

}  // namespace unwrapd::server::jobs
