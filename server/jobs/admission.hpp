#pragma once
// Decides whether a client may send a job now: the queue and the quota of the owner need a free
// slot.

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/http.hpp"
#include "server/jobs/slot_reservations.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server::jobs {

/// A running job.
struct AtWork {
  std::string owner;
  double seconds = 0;  ///< since it began
};

/// What the queue is like now.
struct QueueState {
  store::QueueCounts counts;
  Lengths lengths;  ///< of the newest jobs
  std::int64_t workers = 1;
  std::vector<AtWork> running;
};

/// Not for use by two threads at once.
class Admission {
 public:
  explicit Admission(int places) : places_(places) {}

  /// Reserves a slot of the queue for the sender until leave(), for half a minute. Throws
  /// RetryLater{queue_full} when there is none.
  void check_place(const Applicant& sender, const QueueState& state);
  /// Throws quota_exceeded, or RetryLater{too_many_jobs}, when the owner has reached its quota.
  void check_quota(std::string_view sender, const http::Quota& quota,
                   const store::OwnerUsage& usage, const store::JobRecord& job,
                   const QueueState& state);
  void leave(std::string_view sender) { promised_.leave(sender); }

 private:
  [[nodiscard]] QueueForecast line(const QueueState& state) const;

  const int places_;
  SlotReservations promised_;
  std::map<std::string, SlotReservations> promised_to_owner_;  // of those at the end of their quota
};

}  // namespace unwrapd::server::jobs
