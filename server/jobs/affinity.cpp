#include "server/jobs/affinity.hpp"

#include <algorithm>

namespace unwrapd::server::jobs {
namespace {

constexpr std::chrono::minutes kForgotten{10};  // a job that others have begun, or that is gone

}  // namespace

std::optional<store::WaitingJob> Affinity::choose(const std::vector<store::WaitingJob>& jobs,
                                                  Clock::time_point now) {
  std::erase_if(left_, [&](const auto& left) {
    return now - left.second > kForgotten &&
           std::ranges::find(jobs, left.first, &store::WaitingJob::seq) == jobs.end();
  });
  for (const store::WaitingJob& job : jobs) {
    if (job.is_known_here || !job.is_known_elsewhere) return job;
    if (now - left_.try_emplace(job.seq, now).first->second >= kWait) return job;
  }
  return std::nullopt;
}

void Affinity::count(const store::WaitingJob& job) {
  left_.erase(job.seq);
  if (job.is_known_here)
    ++hits_;
  else if (job.is_known_elsewhere)
    ++misses_;
}

}  // namespace unwrapd::server::jobs
