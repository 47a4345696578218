#pragma once
// Chooses the owner whose job runs next: of those with waiting jobs, the one that has been served
// least so far. Service is the seconds of ended jobs, and for each running job the mean length of
// jobs. An owner that comes back after a pause starts level with the least served of the others, so
// that service cannot be saved up (start-time fair queueing: Goyal, Vin, Cheng, SIGCOMM 1996, with
// jobs for packets). Rejected: one queue in order of arrival, in which a thousand jobs of one key
// make all other keys wait.

#include <cstdint>
#include <map>
#include <string>

#include "server/jobs/slot_reservations.hpp"

namespace unwrapd::server::jobs {

/// Not for use by two threads at once.
class FairShare {
 public:
  /// A job of this owner waits.
  void add(const std::string& owner);
  /// A waiting job of this owner is gone without having run.
  void remove(const std::string& owner);
  /// Forgets all that wait: they are counted anew.
  void forget_waiting();
  /// The owner whose turn it is. Some job must wait.
  [[nodiscard]] std::string next() const;
  /// A job of this owner runs now.
  void start(const std::string& owner);
  /// A job that ran has ended after so long.
  void end(const std::string& owner, double seconds);

  [[nodiscard]] std::int64_t waiting() const { return waiting_; }
  /// Owners with jobs that wait or run.
  [[nodiscard]] std::int64_t owners() const;
  /// Of the newest jobs, the more recent the heavier.
  [[nodiscard]] const Lengths& lengths() const { return lengths_; }

 private:
  struct Account {
    std::int64_t waiting = 0;
    std::int64_t running = 0;
    double served_seconds = 0;
    [[nodiscard]] bool idle() const { return waiting == 0 && running == 0; }
  };
  [[nodiscard]] double service(const Account& account) const;
  [[nodiscard]] double least_service() const;

  std::map<std::string, Account> accounts_;  // of owners with jobs, and of some without
  std::int64_t waiting_ = 0;
  Lengths lengths_;
};

}  // namespace unwrapd::server::jobs
