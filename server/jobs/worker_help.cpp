// The part of worker_pool.hpp for jobs that other workers answer for.
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "server/base/errors.hpp"
#include "server/base/threads.hpp"
#include "server/base/trace.hpp"
#include "server/jobs/worker_pool.hpp"
#include "server/store/stored_input.hpp"

namespace unwrapd::server::jobs {
namespace {

constexpr std::chrono::seconds kLookAtHelp{1};
constexpr int kLooksToFinish = 3;  // that a helper has for its bundle once a job waits

/// A bundle may take as long as a job. Stops the help where its job has ended, or another waits.
void watch_help(WorkSharing& sharing, HelpedJob& helped, const std::stop_token& is_over) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  for (int waiting = 0;
       !wake.wait_for(lock, is_over, kLookAtHelp, [&] { return is_over.stop_requested(); });) {
    try {
      waiting = sharing.is_any_waiting() ? waiting + 1 : 0;
      if (waiting < kLooksToFinish && sharing.is_running(helped)) continue;
    } catch (const std::exception&) {  // the store is away: the deadline is left
      continue;
    }
    helped.stop.request_stop();
    return;
  }
}

}  // namespace

/// What happens here does not count against the job.
void WorkerPool::help_with(HelpedJob& helped) {
  const store::JobRecord& job = helped.record;
  const TraceScope trace(job.trace);
  log_.info("helping with a job", {{"job", job.id}, {"attempt", job.attempt}});
  const Deadline deadline(std::chrono::seconds(limits_.max_job_seconds),
                          [&] { helped.stop.request_stop(); });
  const std::jthread watch(
      [&](const std::stop_token& is_over) { watch_help(queue_.sharing(), helped, is_over); });
  bool has_failed = false;
  try {
    const store::LoadedInput loaded(blobs_, job);
    const auto desk = queue_.sharing().desk_of_helper(helped);
    const work::JobTask task{.record = loaded.record(),
                             .began = helped.began,
                             .stop = helped.stop.get_token(),
                             .desk = desk.get()};
    work::help_isolated(task, loaded.input(), limits_, config_.isolation);
  } catch (const std::exception& error) {
    has_failed = true;
    log_.warning("the help with a job ended", {{"job", job.id}, {"reason", reason_of(error)}});
  }
  queue_.sharing().leave(helped, has_failed);
}

}  // namespace unwrapd::server::jobs
