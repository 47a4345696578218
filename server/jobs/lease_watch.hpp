#pragma once
// Finds running jobs whose node is gone. While a node works on a job, the job's beat rises. No
// clock of another machine is asked: a beat that has not risen for the length of a lease, by the
// clock of this process, belongs to a node that died, froze or lost the store. Its job is queued
// again, and what that node still does for it counts for nothing (the store compares attempt and
// beat).

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/store/job_record.hpp"

namespace unwrapd::server::jobs {

/// Not for use by two threads at once.
class LeaseWatch {
 public:
  using Clock = std::chrono::steady_clock;

  explicit LeaseWatch(std::chrono::milliseconds lease) : lease_(lease) {}

  /// Of these running jobs, those whose beat has been the same for longer than a lease.
  std::vector<store::JobRecord> lapsed(const std::vector<store::JobRecord>& running,
                                       Clock::time_point now);
  /// The store could not be read for a while, in which beats may have risen.
  void forget() { seen_.clear(); }

 private:
  struct Seen {
    int attempt = 0;
    std::int64_t beat = 0;
    Clock::time_point since;
  };

  const std::chrono::milliseconds lease_;
  std::map<std::string, Seen> seen_;  // by the id of the job
};

}  // namespace unwrapd::server::jobs
