#pragma once
// Decides whether a client may send a job now: the queue and the quota of the owner need a free
// slot.

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/http.hpp"
#include "server/jobs/fair_share.hpp"
#include "server/jobs/slot_reservations.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server::jobs {

/// A running job.
struct AtWork {
  std::string_view owner;
  double seconds = 0;  ///< since it began
};

/// Not for use by two threads at once.
class Admission {
 public:
  Admission(int places, int workers) : places_(places), workers_(workers) {}

  /// Reserves a slot of the queue for the sender until leave(), for half a minute. Throws
  /// RetryLater{queue_full} when there is none.
  void check_place(const Applicant& sender, const FairShare& share,
                   const std::vector<AtWork>& running);
  /// Throws quota_exceeded, or RetryLater{too_many_jobs}, when the owner has reached its quota.
  void check_quota(std::string_view sender, const http::Quota& quota,
                   const store::OwnerUsage& usage, const store::JobRecord& job,
                   const FairShare& share, const std::vector<AtWork>& running);
  void leave(std::string_view sender) { promised_.leave(sender); }

 private:
  [[nodiscard]] QueueForecast line(const FairShare& share,
                                   const std::vector<AtWork>& running) const;

  const int places_;
  const int workers_;
  SlotReservations promised_;
  std::map<std::string, SlotReservations> promised_to_owner_;  // of those at the end of their quota
};

}  // namespace unwrapd::server::jobs
