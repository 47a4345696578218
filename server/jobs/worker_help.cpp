// The part of worker_pool.hpp for jobs that other workers answer for.
#include <chrono>
#include <exception>
#include <memory>

#include "server/base/errors.hpp"
#include "server/base/threads.hpp"
#include "server/base/trace.hpp"
#include "server/jobs/worker_pool.hpp"
#include "server/store/stored_input.hpp"

namespace unwrapd::server::jobs {

/// What happens here does not count against the job.
void WorkerPool::help_with(HelpedJob& helped) {
  const store::JobRecord& job = helped.record;
  const TraceScope trace(job.trace);
  log_.info("helping with a job", {{"job", job.id}, {"attempt", job.attempt}});
  const Deadline deadline(std::chrono::seconds(limits_.max_job_seconds),
                          [&] { helped.stop.request_stop(); });
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
