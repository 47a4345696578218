#include "server/worker_pool.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <new>

#include "api/error_table.hpp"
#include "server/deadline.hpp"
#include "server/feed_output.hpp"
#include "server/job_input.hpp"
#include "server/thread_executor.hpp"
#include "server/trace.hpp"

namespace unwrapd::server {
namespace {

using api::JobState;

constexpr std::chrono::seconds kPauseAfterFailure{1};
constexpr int kMaxCrashes = 3;
constexpr int kNice = 10;  // more than others: a tenth of their time where they want it all

/// Of this thread, and of all threads and processes that it starts: work yields to answers, which
/// take microseconds and should not wait for a turn of milliseconds.
void give_way() {
  const auto self = static_cast<id_t>(::gettid());
  ::setpriority(PRIO_PROCESS, self, ::getpriority(PRIO_PROCESS, self) + kNice);
}

/// A stop is a failure when time ran out; else the owner, or the server's end, has stopped the job.
JobOutcome outcome_of(const Error& error, const RunningJob& job, int max_seconds) {
  if (error.code() != ErrorCode::cancelled) return ended(JobState::failed, error, job.record.id);
  if (job.cause != StopCause::time_limit) return ended(JobState::cancelled, error, job.record.id);
  const Error late(ErrorCode::time_limit, "The job took longer than the " +
                                              std::to_string(max_seconds) +
                                              " s allowed; ask for fewer iterations, or send a "
                                              "smaller mesh.");
  return ended(JobState::failed, late, job.record.id);
}

Error too_many_crashes() {
  return {ErrorCode::poison,
          "The process of this job ended three times while it worked on it; it is not tried "
          "again. Check the mesh, or send a smaller part of it."};
}

}  // namespace

WorkerPool::WorkerPool(JobQueue& queue, BlobStore& blobs, const api::Limits& limits, const Log& log,
                       const WorkerConfig& config)
    : queue_(queue), blobs_(blobs), limits_(limits), log_(log), config_(config) {
  threads_.reserve(static_cast<std::size_t>(config.workers));
  for (int worker = 0; worker < config.workers; ++worker) threads_.emplace_back([this] { work(); });
}

void WorkerPool::work() {
  give_way();
  ThreadExecutor executor(config_.threads, config_.core);
  while (true) {
    try {
      const std::shared_ptr<RunningJob> job = queue_.take();
      if (!job) return;
      work_on(*job, executor);
    } catch (const std::exception& error) {  // the store: the job is run again at the next start
      log_.error("a worker failed", {{"reason", error.what()}});
      std::this_thread::sleep_for(kPauseAfterFailure);
    }
  }
}

void WorkerPool::work_on(RunningJob& job, Executor& executor) {
  const TraceScope trace(job.feed->trace());
  log_.info("job started", {{"job", job.record.id}, {"attempt", job.record.attempt}});
  Claim claim(*config_.claims, job.record.owner);  // until the store counts the results
  JobOutcome outcome;
  {
    const Deadline deadline(std::chrono::seconds(limits_.max_job_seconds),
                            [&] { job.request_stop(StopCause::time_limit); });
    outcome = attempt(job, {executor, claim});
  }
  queue_.finish(job, std::move(outcome), [&] { claim.give_up(); });
}

std::string WorkerPool::run(const RunningJob& job, const Means& means) {
  const LoadedInput loaded(blobs_, job.record);
  FeedOutput output(job, blobs_, {means.claim, config_.most_bytes});
  const auto queue_ms = static_cast<double>(job.started_ms - job.record.created_ms);
  const JobTask task{.record = loaded.record(),
                     .queue_ms = std::max(0.0, queue_ms),
                     .began = job.began,
                     .stop = job.stop.get_token()};
  const bool suspected = job.record.crashes > 0 && config_.isolation.possible;
  if (!config_.isolation.on && !suspected)
    return config_.duties.run(task, loaded.input(), output, limits_, means.executor);
  try {
    return run_job_isolated(task, loaded.input(), output, limits_, config_.isolation);
  } catch (const Error& error) {
    const bool asked = error.code() != ErrorCode::cancelled || job.stop.stop_requested();
    if (!asked) throw WorkerCrashed("somebody else told it to stop");
    throw;
  }
}

/// Again after a crash, which may have been an accident: the memory of the machine, an operator.
std::string WorkerPool::run_patiently(const RunningJob& job, const Means& means) {
  for (int crashes = 1;; ++crashes) {
    try {
      return run(job, means);
    } catch (const WorkerCrashed& crash) {
      log_.warning("a worker process ended",
                   {{"job", job.record.id}, {"how", crash.what()}, {"crashes", crashes}});
    }
    if (crashes == kMaxCrashes) throw too_many_crashes();
  }
}

JobOutcome WorkerPool::attempt(const RunningJob& job, const Means& means) {
  try {
    JobOutcome outcome;
    outcome.result_format = run_patiently(job, means);
    return outcome;
  } catch (const Error& error) {
    return outcome_of(error, job, limits_.max_job_seconds);
  } catch (const std::bad_alloc&) {
    const Error error(ErrorCode::memory_limit,
                      "The memory of the server did not suffice; send a smaller mesh.");
    return ended(JobState::failed, error, job.record.id);
  } catch (const std::exception& error) {  // the owner learns nothing of our insides
    log_.error("unhandled exception", {{"job", job.record.id}, {"reason", error.what()}});
    return ended(JobState::failed, Error(ErrorCode::internal, "The server made a mistake."),
                 job.record.id);
  }
}

}  // namespace unwrapd::server
