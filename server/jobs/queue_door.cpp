#include "server/jobs/queue_door.hpp"

#include <algorithm>

#include "server/base/queue_errors.hpp"

namespace unwrapd::server {

using Clock = PromisedPlaces::Clock;

Line QueueDoor::line(const FairShare& share, const std::vector<AtWork>& running) const {
  std::vector<double> ran;
  for (const AtWork& job : running) ran.push_back(job.seconds);
  return line_before(places_, share.waiting(), workers_, share.lengths(), ran);
}

void QueueDoor::check_place(const Asker& sender, const FairShare& share,
                            const std::vector<AtWork>& running) {
  if (const auto later = promised_.ask(Clock::now(), sender, line(share, running)))
    throw queue_full(places_, *later);
}

/// The owners with jobs share the workers: one of his ends once in so many.
void QueueDoor::check_quota(std::string_view sender, const Quota& quota, const OwnerUsage& usage,
                            const JobRecord& job, const FairShare& share,
                            const std::vector<AtWork>& running) {
  if (quota.max_bytes > 0 && usage.stored_bytes + job.stored_bytes > quota.max_bytes)
    throw quota_exceeded(quota.max_bytes);
  if (quota.max_jobs == 0) return;
  Line his = line(share, running);
  const auto owners = static_cast<double>(std::max<std::int64_t>(1, share.owners()));
  his.places = quota.max_jobs;
  his.waiting = usage.live_jobs;
  his.interval *= owners;
  his.spread *= owners;
  if (std::ranges::count(running, job.owner, &AtWork::owner) == 0)
    his.first += his.interval + share.lengths().mean;
  PromisedPlaces& promised = promised_to_owner_[job.owner];
  const auto later = promised.ask(Clock::now(), {.who = sender}, his);
  promised.leave(sender);
  std::erase_if(promised_to_owner_, [](const auto& entry) { return entry.second.empty(); });
  if (later) throw too_many_jobs(quota.max_jobs, *later);
}

}  // namespace unwrapd::server
