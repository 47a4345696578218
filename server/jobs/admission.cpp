#include "server/jobs/admission.hpp"

#include <algorithm>

#include "server/base/errors.hpp"

namespace unwrapd::server::jobs {

using Clock = SlotReservations::Clock;

QueueForecast Admission::line(const QueueState& state) const {
  std::vector<double> ran;
  for (const AtWork& job : state.running) ran.push_back(job.seconds);
  return forecast_queue(places_, state.counts.waiting, static_cast<int>(state.workers),
                        state.lengths, ran);
}

void Admission::check_place(const Applicant& sender, const QueueState& state) {
  if (const auto later = promised_.ask(Clock::now(), sender, line(state)))
    throw queue_full(places_, *later);
}

/// Owners with jobs share the workers: of as many jobs that end as there are owners, one is of this
/// owner.
void Admission::check_quota(std::string_view sender, const http::Quota& quota,
                            const store::OwnerUsage& usage, const store::JobRecord& job,
                            const QueueState& state) {
  if (quota.max_bytes > 0 && usage.stored_bytes + job.stored_bytes > quota.max_bytes)
    throw quota_exceeded(quota.max_bytes);
  if (quota.max_jobs == 0) return;
  QueueForecast own = line(state);
  const auto owners = static_cast<double>(std::max<std::int64_t>(1, state.counts.owners));
  own.places = quota.max_jobs;
  own.waiting = usage.live_jobs;
  own.interval *= owners;
  own.spread *= owners;
  if (std::ranges::count(state.running, job.owner, &AtWork::owner) == 0)
    own.first += own.interval + state.lengths.mean;
  SlotReservations& promised = promised_to_owner_[job.owner];
  const auto later = promised.ask(Clock::now(), {.who = sender}, own);
  promised.leave(sender);
  std::erase_if(promised_to_owner_, [](const auto& entry) { return entry.second.empty(); });
  if (later) throw too_many_jobs(quota.max_jobs, *later);
}

}  // namespace unwrapd::server::jobs
