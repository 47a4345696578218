#include "server/jobs/lease_watch.hpp"

#include <utility>

namespace unwrapd::server::jobs {

std::vector<store::JobRecord> LeaseWatch::lapsed(const std::vector<store::JobRecord>& running,
                                                 Clock::time_point now) {
  std::map<std::string, Seen> seen;
  std::vector<store::JobRecord> lapsed;
  for (const store::JobRecord& job : running) {
    const Seen shown{.attempt = job.attempt, .beat = job.beat, .since = now};
    const auto before = seen_.find(job.id);
    const bool is_same = before != seen_.end() && before->second.attempt == shown.attempt &&
                         before->second.beat == shown.beat;
    const Seen& known = seen.emplace(job.id, is_same ? before->second : shown).first->second;
    if (now - known.since > lease_) lapsed.push_back(job);
  }
  seen_ = std::move(seen);
  return lapsed;
}

}  // namespace unwrapd::server::jobs
