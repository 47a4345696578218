// The part of job_queue.hpp for the end of the server.
#include "server/base/errors.hpp"
#include "server/jobs/job_queue.hpp"

namespace unwrapd::server::jobs {

void JobQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  sharing_.close();
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
    if (stored && stored->state == api::JobState::running) take_up(*stored, Found::not_stopping);
  } catch (const Error& error) {  // the next start finds it
    log_.warning("job that does not stop could not be queued again",
                 {{"job", id}, {"reason", reason_of(error)}});
  }
}

}  // namespace unwrapd::server::jobs
